//! Looking into JSON.

use geometry::LatLon;
use serde_json::Value;

/// A finite number of an object.
pub fn number(object: &Value, key: &str) -> Option<f64> {
    object.get(key)?.as_f64().filter(|n| n.is_finite())
}

/// A flag of an object; false if there is none.
pub fn flag(object: &Value, key: &str) -> bool {
    object.get(key).and_then(Value::as_bool).unwrap_or(false)
}

/// A list of an object; empty if there is none.
pub fn list<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    object.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// `[latitude, longitude]` with or without an altitude.
pub fn position(value: &Value) -> Option<LatLon> {
    let position = LatLon::new(value.get(0)?.as_f64()?, value.get(1)?.as_f64()?);
    position.is_valid().then_some(position)
}

/// `[latitude, longitude, altitude]`; the altitude may be missing or `null`.
pub fn position_3d(value: &Value) -> Option<(LatLon, Option<f64>)> {
    let altitude_m = value.get(2).and_then(Value::as_f64).filter(|m| m.is_finite());
    Some((position(value)?, altitude_m.map(|m| m.clamp(-1e5, 1e5))))
}

/// A position as QGC writes it.
pub fn of(position: LatLon) -> Value {
    serde_json::json!([position.lat_deg, position.lon_deg])
}
