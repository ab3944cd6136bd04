//! Bytes on the wire: CBOR by default, JSON from anyone who says so.
// payloads come from the network
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use serde::Serialize;
use serde::de::DeserializeOwned;
use zenoh::bytes::{Encoding, ZBytes};

/// Payloads beyond this are not decoded, bytes.
const PAYLOAD_MAX: usize = 16 << 20;

/// How a payload is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// RFC 8949, what our own programs send.
    Cbor,
    /// RFC 8259, for scripts and people.
    Json,
}

impl Format {
    /// What a sample's encoding says; text counts as JSON, everything else as CBOR.
    pub(crate) fn of(encoding: &Encoding) -> Self {
        let json = [
            &Encoding::APPLICATION_JSON,
            &Encoding::TEXT_JSON,
            &Encoding::TEXT_PLAIN,
            &Encoding::ZENOH_STRING,
        ];
        if json.contains(&encoding) { Self::Json } else { Self::Cbor }
    }

    pub(crate) fn encoding(self) -> Encoding {
        match self {
            Self::Cbor => Encoding::APPLICATION_CBOR,
            Self::Json => Encoding::APPLICATION_JSON,
        }
    }
}

/// Writes a value.
///
/// # Errors
/// A sentence, for values that the format cannot hold.
pub(crate) fn encode<T: Serialize>(value: &T, format: Format) -> Result<Vec<u8>, String> {
    match format {
        Format::Json => serde_json::to_vec(value).map_err(|e| e.to_string()),
        Format::Cbor => {
            let mut bytes = Vec::with_capacity(128);
            ciborium::into_writer(value, &mut bytes).map_err(|e| e.to_string())?;
            Ok(bytes)
        }
    }
}

/// Reads a value; an absent payload counts as an empty object.
///
/// # Errors
/// A sentence that says what is wrong.
pub(crate) fn decode<T: DeserializeOwned>(payload: &ZBytes, encoding: &Encoding) -> Result<T, String> {
    if payload.len() > PAYLOAD_MAX {
        return Err(format!("payload of {} bytes is larger than {PAYLOAD_MAX}", payload.len()));
    }
    if payload.is_empty() {
        return serde_json::from_str("{}").map_err(|e| format!("empty payload: {e}"));
    }
    decode_bytes(&payload.to_bytes(), Format::of(encoding))
}

pub(crate) fn decode_bytes<T: DeserializeOwned>(bytes: &[u8], format: Format) -> Result<T, String> {
    match format {
        Format::Json => serde_json::from_slice(bytes).map_err(|e| format!("not the JSON expected: {e}")),
        Format::Cbor => decode_cbor(bytes),
    }
}

fn decode_cbor<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let mut rest = bytes;
    let value = ciborium::from_reader(&mut rest).map_err(|e| format!("not the CBOR expected: {e}"))?;
    if rest.is_empty() {
        Ok(value)
    } else {
        Err(format!("{} bytes too many after the CBOR value", rest.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::*;
    use proptest::prelude::*;
    use std::fmt::Debug;

    fn check<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
        for format in [Format::Cbor, Format::Json] {
            let bytes = encode(value, format).unwrap();
            assert_eq!(&decode_bytes::<T>(&bytes, format).unwrap(), value, "{format:?}");
        }
    }

    #[test]
    fn tagged_and_nested_types_survive_both_formats() {
        check(&Command::Start);
        check(&Command::SetVariable { name: "fire".into(), value: VariableValue::Number(3.0) });
        check(&Command::SetVariable {
            name: "centre".into(),
            value: VariableValue::Position(LatLon { lat_deg: 36.5, lon_deg: -84.0 }),
        });
        check(&Command::Emergency { cause: Cause::Engine, plan: None });
        check(&GatewayRequest::Direct { heading_deg: 10.0, altitude_amsl_m: 500.0, airspeed_mps: 22.0 });
        check(&FeedAnswer::Refused { faults: vec![(Token(7), "range".into(), "too far".into())] });
        check(&FeedAnswer::Full);
        check(&Stamped {
            time_s: 1.0,
            validity_s: 2.0,
            value: GatewayEvent::Progress { current: Some(Token(u64::MAX)), taken: Token(u64::MAX) },
        });
        check(&Stamped {
            time_s: 1.0,
            validity_s: 2.0,
            value: PlanEvent::PlanActivated { hash: "ab".into(), revision: 2 },
        });
    }

    #[test]
    fn an_absent_payload_is_an_empty_request() {
        decode::<Empty>(&ZBytes::new(), &Encoding::ZENOH_BYTES).unwrap();
        assert!(decode::<Propose>(&ZBytes::new(), &Encoding::ZENOH_BYTES).is_err());
    }

    #[test]
    fn deep_nesting_is_refused() {
        for (bytes, format) in [(vec![0x81; 100_000], Format::Cbor), (vec![b'['; 100_000], Format::Json)] {
            assert!(decode_bytes::<serde_json::Value>(&bytes, format).is_err());
        }
    }

    #[test]
    fn a_length_that_lies_is_refused() {
        let bytes = [0x9b, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff];
        assert!(decode_bytes::<Vec<u64>>(&bytes, Format::Cbor).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]
        #[test]
        fn garbage_is_an_error_not_a_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            for format in [Format::Cbor, Format::Json] {
                let _ = decode_bytes::<Command>(&bytes, format);
                let _ = decode_bytes::<Stamped<GatewayStatus>>(&bytes, format);
                let _ = decode_bytes::<Feed>(&bytes, format);
            }
        }
    }
}
