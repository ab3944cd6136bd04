//! CBOR as JSON, without a tree in between: a message is looked at once.
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use serde::de::DeserializeSeed;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::io::Write;

/// Writes a CBOR value as JSON. Numbers that JSON has not (NaN, infinities) become `null`, bytes a list of numbers.
///
/// # Errors
/// A sentence: the bytes are not one CBOR value, or one that JSON can't hold (a key that is no text).
pub fn from_cbor(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut rest = bytes;
    let Json(text) = ciborium::from_reader(&mut rest).map_err(|e| format!("not CBOR: {e}"))?;
    if rest.is_empty() {
        Ok(text)
    } else {
        Err(format!("{} bytes too many behind the CBOR value", rest.len()))
    }
}

/// Any text that is one JSON value.
///
/// # Errors
/// A sentence that says what is wrong.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    serde_json::from_slice::<serde::de::IgnoredAny>(bytes).map(|_| ()).map_err(|e| format!("not JSON: {e}"))
}

struct Json(Vec<u8>);

impl<'de> Deserialize<'de> for Json {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut out = Vec::with_capacity(256);
        deserializer.deserialize_any(Writer(&mut out))?;
        Ok(Self(out))
    }
}

/// Appends the value that it visits.
struct Writer<'a>(&'a mut Vec<u8>);

impl Writer<'_> {
    fn put<E: Error>(self, value: &(impl serde::Serialize + ?Sized)) -> Result<(), E> {
        serde_json::to_writer(self.0, value).map_err(E::custom)
    }
}

impl<'de> DeserializeSeed<'de> for Writer<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Writer<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value that JSON can hold")
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        self.put(&value)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<(), E> {
        self.put(&value)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<(), E> {
        self.put(&value)
    }

    fn visit_i128<E: Error>(self, value: i128) -> Result<(), E> {
        self.put(&value)
    }

    fn visit_u128<E: Error>(self, value: u128) -> Result<(), E> {
        self.put(&value)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<(), E> {
        // serde_json writes what is no number as null
        self.put(&value)
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<(), E> {
        self.put(value)
    }

    fn visit_bytes<E: Error>(self, value: &[u8]) -> Result<(), E> {
        self.put(value)
    }

    fn visit_none<E: Error>(self) -> Result<(), E> {
        self.visit_unit()
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.0.extend_from_slice(b"null");
        Ok(())
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        let out = self.0;
        out.push(b'[');
        let mut next = out.len();
        while items.next_element_seed(Writer(out))?.is_some() {
            next = out.len();
            out.push(b',');
        }
        out.truncate(next);
        out.push(b']');
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        let out = self.0;
        out.push(b'{');
        let mut next = out.len();
        while let Some(key) = entries.next_key::<String>()? {
            serde_json::to_writer(&mut *out, &key).map_err(A::Error::custom)?;
            out.write_all(b":").map_err(A::Error::custom)?;
            entries.next_value_seed(Writer(out))?;
            next = out.len();
            out.push(b',');
        }
        out.truncate(next);
        out.push(b'}');
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::{Value, json};

    fn cbor(value: &impl serde::Serialize) -> Vec<u8> {
        let mut bytes = Vec::new();
        ciborium::into_writer(value, &mut bytes).unwrap();
        bytes
    }

    fn value() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<bool>().prop_map(Value::from),
            any::<i64>().prop_map(Value::from),
            any::<u64>().prop_map(Value::from),
            (-1e12..1e12f64).prop_map(Value::from),
            ".{0,12}".prop_map(Value::from),
        ];
        leaf.prop_recursive(4, 40, 6, |inner| {
            prop_oneof![
                proptest::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
                proptest::collection::btree_map(".{0,6}", inner, 0..6)
                    .prop_map(|m| Value::Object(m.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

        #[test]
        fn every_value_comes_out_as_it_is(value in value()) {
            let text = from_cbor(&cbor(&value)).unwrap();
            // not by value: the reader rounds numbers, the writer does not
            prop_assert_eq!(String::from_utf8(text).unwrap(), value.to_string());
        }

        #[test]
        fn garbage_is_an_error_or_json(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            if let Ok(text) = from_cbor(&bytes) {
                prop_assert!(check(&text).is_ok());
            }
        }
    }

    #[test]
    fn what_json_has_not() {
        assert_eq!(from_cbor(&cbor(&[f64::NAN, f64::INFINITY])).unwrap(), b"[null,null]");
        assert_eq!(from_cbor(&cbor(&ciborium::Value::Bytes(vec![1, 2]))).unwrap(), b"[1,2]");
        assert!(from_cbor(&cbor(&ciborium::Value::Map(vec![(1.into(), 2.into())]))).is_err());
        assert!(from_cbor(&[0x81; 100_000]).is_err(), "deep nesting");
        assert!(
            from_cbor(&[0x9b, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]).is_err(),
            "a length that lies"
        );
        assert!(from_cbor(&[cbor(&1), cbor(&2)].concat()).is_err(), "two values");
        assert_eq!(from_cbor(&cbor(&json!({}))).unwrap(), b"{}");
    }
}
