//! The flight-test programme on the personalities of our simulator, with the real binaries and in lockstep: time goes on only
//! when the test says so. Those on PX4, and some on either, are flown with `--release`: all of
//! them take long otherwise.
#![cfg(test)]

use system_tests::programme::{scenario, scenarios};

/// A test for each scenario and personality.
macro_rules! programme {
    ($($(#[$how:meta])* $name:ident)*) => {
        programme!(arduplane: $(#[cfg(test)] $(#[$how])* $name)*);
        programme!(px4: $(#[cfg_attr(debug_assertions, ignore = "flown with --release")] $name)*);

        #[test]
        fn every_scenario_is_flown() {
            let flown = [$(stringify!($name)),*];
            assert_eq!(scenarios().map(|s| s.name).collect::<Vec<_>>(), flown);
        }
    };
    ($personality:ident: $($(#[$how:meta])* $name:ident)*) => {
        mod $personality {
            $(
                $(#[$how])*
                #[tokio::test(flavor = "multi_thread")]
                async fn $name() {
                    super::fly(stringify!($personality), stringify!($name)).await;
                }
            )*
        }
    };
}

async fn fly(personality: &str, name: &str) {
    let flown = scenario(name).unwrap().simulate(personality).await;
    assert!(flown.is_ok(), "{:#}", flown.unwrap_err());
}

programme! {
    nominal
    strong_wind
    bad_radio
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_alternates
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_coast_patrol
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_fire_watch
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_navaid_inspection
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_pipeline
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_search
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    example_square
    variable_moves_the_sweep
    plan_update_in_flight
    decision_by_default
    decision_by_operator
    hold_and_resume
    emergency_at_leg_level
    emergency_at_stage_level
    emergency_at_plan_level
    engine_lost
    engine_lost_unreported
    battery_low
    gps_lost
    fp_manager_killed
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    fp_manager_frozen
    fp_manager_gone_for_good
    gateway_killed
    agent_restarted
    ground_station_gone
    link_cut_1_s
    link_cut_5_s
    link_cut_30_s
    link_cut_300_s
    pilot_takes_over_and_gives_back
    operator_takes_back
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    geofence_breached
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    list_replaced
    #[cfg_attr(debug_assertions, ignore = "flown with --release")]
    list_replaced_and_flown
}
