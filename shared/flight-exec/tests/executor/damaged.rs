//! Snapshots whose parts don't fit together: refused, whatever is missing.

use crate::rig::{GROUND_M, Rig, document, fix};
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

fn part<'a>(value: &'a mut Value, name: &str) -> &'a mut Value {
    let fields = value.as_map_mut().unwrap();
    &mut fields.iter_mut().find(|(key, _)| key.as_text() == Some(name)).unwrap().1
}

/// The list of that name, or of that name within another part.
fn list<'a>(snapshot: &'a mut Value, name: &str) -> &'a mut Vec<Value> {
    name.split('.').fold(snapshot, part).as_array_mut().unwrap()
}

/// What it doesn't say is not made up.
#[test]
fn a_snapshot_whose_state_says_less_is_not_read() {
    let (_, whole) = snapshot();
    assert!(whole.deserialized::<Snapshot>().is_ok());
    let fields = [
        ("life.values", "written"),
        ("life.revision", "reviewed_ahead_only"),
        ("flight.questions", "late"),
        ("flight.overrides", "counts"),
        ("flight.acting", "acted_s"),
    ];
    let life = ["mode", "clock", "numbers", "revision", "values"].map(|name| ("life", name));
    let flight = ["horizon", "questions", "acting", "overrides", "emergencies", "reported"];
    let parts = life.into_iter().chain(flight.map(|name| ("flight", name)));
    for (of, name) in fields.into_iter().chain(parts) {
        let mut value = whole.clone();
        let fields = of.split('.').fold(&mut value, part).as_map_mut().unwrap();
        let said = fields.len();
        fields.retain(|(key, _)| key.as_text() != Some(name));
        assert_eq!(fields.len(), said - 1, "{of}.{name}");
        assert!(value.deserialized::<Snapshot>().is_err(), "{of}.{name}");
    }
}

#[test]
fn a_snapshot_without_one_of_its_parts_is_refused() {
    let whole = "";
    for name in ["shared.expansions", "shared.trails", "of_bookmarks", "sealed", whole] {
        let (rig, mut value) = snapshot();
        if name != whole {
            assert!(list(&mut value, name).pop().is_some(), "{name}");
        }
        assert_eq!(restored(&rig, value), (name != whole).then_some(RestoreError::Damaged), "{name}");
    }
}

#[test]
fn a_snapshot_whose_bookmarks_are_in_fewer_loops_is_refused() {
    let (rig, mut value) = snapshot();
    let mut shortened = 0;
    for of_bookmark in list(&mut value, "of_bookmarks") {
        shortened += usize::from(list(of_bookmark, "loops").pop().is_some());
    }
    assert!(shortened > 0);
    assert_eq!(restored(&rig, value), Some(RestoreError::Damaged));
}

fn restored(rig: &Rig, damaged: Value) -> Option<RestoreError> {
    let damaged: Snapshot = damaged.deserialized().unwrap();
    let plan = rig.executor.program().cloned();
    let (terrain, profile) = (Arc::new(terrain::Flat(GROUND_M)), aircraft::Profile::default());
    Executor::restore(Config::default(), terrain, profile, plan, damaged).err()
}

/// Each bookmark ahead knows the way back, with the patterns on it: they are written once for all of them.
#[test]
fn a_snapshot_in_a_long_loop_is_as_large_as_the_loop() {
    let size = |legs: usize, passes: usize| {
        let leg = |i: usize| {
            let at = fix("B2").destination(90.0, 100.0 * i as f64);
            format!(r#"<TF id="t{i}" lat="{}" lon="{}"/>"#, at.lat_deg, at.lon_deg)
        };
        let body: String = (0..legs).map(leg).collect();
        let pattern = r#"<scan id="s" spacing="100" heading="0"><area fix="C4" radius="500"/></scan>"#;
        let loops = format!(
            r#"<iterative id="l" form="reverse" count="3">{pattern}{body}</iterative><TF id="z" fix="A3"/>"#
        );
        let mut rig = Rig::flying(&document(&loops));
        for _ in 0..passes {
            rig.fly_to(&format!("t{}", legs - 30));
            rig.fly_one();
        }
        let mut bytes = Vec::new();
        ciborium::into_writer(&rig.executor.snapshot(), &mut bytes).unwrap();
        (bytes.len(), rig.buffer.len())
    };
    for passes in [1, 2] {
        let ((short, ahead), (long, _)) = (size(100, passes), size(300, passes));
        assert!(ahead > 20, "{ahead}");
        assert!(long - short < 200 * 400, "{short} bytes for 100 legs, {long} for 300, pass {passes}");
    }
}
