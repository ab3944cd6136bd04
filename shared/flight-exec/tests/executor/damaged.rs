//! Snapshots whose parts don't fit together: refused, whatever is missing.

use crate::rig::{GROUND_M, Rig};
use ciborium::Value;
use flight_exec::{Config, Executor, RestoreError, Snapshot};
use std::sync::Arc;

/// In a pattern, with choices ahead.
fn snapshot() -> (Rig, Value) {
    let mut rig = Rig::started(
        r#"<TF id="a" fix="B1"/><iterative id="l" form="reverse" count="2"><TF id="b" fix="B2"/>
           <scan id="s" spacing="300" heading="0"><area fix="C4" radius="500"/></scan></iterative><TF id="z" fix="A3"/>"#,
    );
    rig.fly_to("s");
    let value = Value::serialized(&rig.executor.snapshot()).unwrap();
    (rig, value)
}

/// The list of that name.
fn list<'a>(snapshot: &'a mut Value, name: &str) -> &'a mut Vec<Value> {
    let fields = snapshot.as_map_mut().unwrap();
    let field = fields.iter_mut().find(|(key, _)| key.as_text() == Some(name)).unwrap();
    field.1.as_array_mut().unwrap()
}

#[test]
fn a_snapshot_without_one_of_its_parts_is_refused() {
    for (name, whole) in
        [("expansions", false), ("in_expansion", false), ("sealed", false), ("expansions", true)]
    {
        let (rig, mut value) = snapshot();
        let parts = list(&mut value, name);
        assert!(!parts.is_empty(), "{name}");
        if !whole {
            parts.pop();
        }
        let damaged: Snapshot = value.deserialized().unwrap();
        let plan = rig.executor.program().cloned();
        let (terrain, profile) = (Arc::new(terrain::Flat(GROUND_M)), aircraft::Profile::default());
        let restored = Executor::restore(Config::default(), terrain, profile, plan, damaged);
        let expected = if whole { None } else { Some(RestoreError::Damaged) };
        assert_eq!(restored.err(), expected, "{name}");
    }
}
