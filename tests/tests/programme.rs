//! The flight-test programme on the personalities of our simulator, with the real binaries and in lockstep: time goes on only
//! when the test says so. A build without optimisation takes minutes for all of them, so it flies only those marked `always`, as
//! ArduPlane; with `--release` each is flown as both.
#![cfg(test)]

use system_tests::programme::{scenario, scenarios};

/// A test for each scenario and personality.
macro_rules! programme {
    ($($name:ident $($always:ident)?,)*) => {
        mod arduplane {
            $(programme!(@flight arduplane $name $($always)?);)*
        }
        mod px4 {
            $(programme!(@flight px4 $name);)*
        }

        #[test]
        fn every_scenario_is_flown() {
            let flown = [$(stringify!($name)),*];
            assert_eq!(scenarios().map(|s| s.name).collect::<Vec<_>>(), flown);
        }
    };
    (@flight $personality:ident $name:ident always) => {
        #[tokio::test(flavor = "multi_thread")]
        async fn $name() {
            super::fly(stringify!($personality), stringify!($name)).await;
        }
    };
    (@flight $personality:ident $name:ident) => {
        #[tokio::test(flavor = "multi_thread")]
        #[cfg_attr(debug_assertions, ignore = "flown with --release")]
        async fn $name() {
            super::fly(stringify!($personality), stringify!($name)).await;
        }
    };
}

async fn fly(personality: &str, name: &str) {
    let flown = scenario(name).unwrap().simulate(personality).await;
    assert!(flown.is_ok(), "{:#}", flown.unwrap_err());
}

/// It takes off and lands as one, and is flown as a wing in between.
#[tokio::test(flavor = "multi_thread")]
#[cfg_attr(debug_assertions, ignore = "flown with --release")]
async fn nominal_on_a_vtol() {
    fly("px4-vtol", "nominal").await;
}

programme! {
    nominal always,
    strong_wind,
    strong_wind_in_flight,
    bad_radio always,
    accuracy,
    accuracy_at_10_mps,
    example_alternates,
    example_coast_patrol,
    example_fire_watch,
    example_navaid_inspection,
    example_pipeline,
    example_search,
    example_square,
    variable_moves_the_sweep,
    plan_update_in_flight,
    decision_by_default,
    decision_by_operator,
    hold_and_resume,
    hold_in_climb,
    emergency_in_climb,
    hold_in_landing,
    emergency_at_leg_level,
    emergency_at_stage_level,
    emergency_at_plan_level,
    engine_lost always,
    engine_lost_unreported,
    iced,
    battery_low,
    gps_lost,
    ended_by_force,
    fp_manager_killed always,
    fp_manager_frozen,
    fp_manager_gone_for_good,
    runways_taken_away,
    gateway_killed,
    gateway_without_memory,
    both_killed,
    agent_restarted,
    ground_station_gone,
    link_cut_1_s,
    link_cut_5_s,
    link_cut_30_s,
    link_cut_300_s,
    pilot_takes_over_and_gives_back,
    operator_takes_back,
    geofence_breached,
    list_replaced,
    list_replaced_and_flown,
}
