//! Numbers of MAVLink commands and frames that are understood here, and names of those that are only mentioned in notes.
//! Source: the `common` dialect, enums MAV_CMD and MAV_FRAME.

/// Fly to a waypoint: hold s, acceptance radius m, pass radius m, yaw.
pub const WAYPOINT: u16 = 16;
/// Circle for ever: -, -, radius m, yaw.
pub const LOITER_UNLIMITED: u16 = 17;
/// Circle a number of times: turns, -, radius m.
pub const LOITER_TURNS: u16 = 18;
/// Circle for a time: seconds, -, radius m.
pub const LOITER_TIME: u16 = 19;
/// Return to the launch position and land.
pub const RETURN_TO_LAUNCH: u16 = 20;
/// Land: -, -, -, yaw.
pub const LAND: u16 = 21;
/// Take off: pitch, -, -, yaw.
pub const TAKEOFF: u16 = 22;
/// Circle until an altitude is reached: -, radius m.
pub const LOITER_TO_ALTITUDE: u16 = 31;
/// A waypoint of a spline.
pub const SPLINE_WAYPOINT: u16 = 82;
/// Take off vertically.
pub const VTOL_TAKEOFF: u16 = 84;
/// Land vertically.
pub const VTOL_LAND: u16 = 85;
/// Wait: seconds.
pub const DELAY: u16 = 93;
/// Go back: to the item numbered, so many times.
pub const JUMP: u16 = 177;
/// Speed: 0 airspeed, 1 ground speed; m/s; throttle.
pub const CHANGE_SPEED: u16 = 178;
/// Marks where a landing begins.
pub const LAND_START: u16 = 189;
/// Camera: ..., parameter 5 is 1 to take a picture.
pub const DIGICAM_CONTROL: u16 = 203;
/// Camera: a picture each so many metres, 0 to stop.
pub const CAMERA_TRIGGER_DISTANCE: u16 = 206;
/// Camera: -, interval s, number of pictures (0: for ever).
pub const IMAGE_START_CAPTURE: u16 = 2000;
/// Camera: stop.
pub const IMAGE_STOP_CAPTURE: u16 = 2001;
/// Video: start.
pub const VIDEO_START_CAPTURE: u16 = 2500;
/// Video: stop.
pub const VIDEO_STOP_CAPTURE: u16 = 2501;

/// Where to go when a fence is crossed.
pub const FENCE_RETURN: u16 = 5000;
/// A corner of a polygon to stay inside of: number of corners.
pub const FENCE_INCLUSION: u16 = 5001;
/// A corner of a polygon to keep out of: number of corners.
pub const FENCE_EXCLUSION: u16 = 5002;
/// A circle to stay inside of: radius m.
pub const FENCE_CIRCLE_INCLUSION: u16 = 5003;
/// A circle to keep out of: radius m.
pub const FENCE_CIRCLE_EXCLUSION: u16 = 5004;
/// All of them.
pub const FENCES: [u16; 5] =
    [FENCE_RETURN, FENCE_INCLUSION, FENCE_EXCLUSION, FENCE_CIRCLE_INCLUSION, FENCE_CIRCLE_EXCLUSION];
/// A rally point.
pub const RALLY_POINT: u16 = 5100;

/// Altitude above mean sea level.
pub const FRAME_GLOBAL: u16 = 0;
/// No position: a command.
pub const FRAME_MISSION: u16 = 2;
/// Altitude above home.
pub const FRAME_RELATIVE: u16 = 3;
/// As `FRAME_GLOBAL`, sent as integers.
pub const FRAME_GLOBAL_INT: u16 = 5;
/// As `FRAME_RELATIVE`, sent as integers.
pub const FRAME_RELATIVE_INT: u16 = 6;
/// Altitude above terrain.
pub const FRAME_TERRAIN: u16 = 10;
/// As `FRAME_TERRAIN`, sent as integers.
pub const FRAME_TERRAIN_INT: u16 = 11;
/// Positions are metres from somewhere: `MAV_FRAME_LOCAL_NED`, `LOCAL_ENU`, `LOCAL_OFFSET_NED`, `BODY_NED`, `BODY_OFFSET_NED`,
/// `BODY_FRD`, `LOCAL_FRD` and `LOCAL_FLU`.
pub const LOCAL_FRAMES: [u16; 8] = [1, 4, 7, 8, 9, 12, 20, 21];

/// Altitudes of this frame are heights above home or above ground.
pub fn counts_from_below(frame: u16) -> bool {
    matches!(frame, FRAME_RELATIVE | FRAME_RELATIVE_INT | FRAME_TERRAIN | FRAME_TERRAIN_INT)
}

/// This command is about a place on the way; one without a position would be done on the spot.
pub fn is_somewhere(command: u16) -> bool {
    matches!(
        command,
        WAYPOINT
            | SPLINE_WAYPOINT
            | LOITER_UNLIMITED
            | LOITER_TURNS
            | LOITER_TIME
            | LOITER_TO_ALTITUDE
            | LAND
            | VTOL_LAND
    )
}

/// Commands that have no counterpart in a plan, with their names.
const DESCRIBED: &[(u16, &str)] = &[
    (30, "NAV_CONTINUE_AND_CHANGE_ALT"),
    (33, "NAV_FOLLOW"),
    (80, "NAV_ROI"),
    (83, "NAV_ALTITUDE_WAIT"),
    (92, "NAV_GUIDED_ENABLE"),
    (94, "NAV_PAYLOAD_PLACE"),
    (112, "CONDITION_DELAY"),
    (114, "CONDITION_DISTANCE"),
    (115, "CONDITION_YAW"),
    (176, "DO_SET_MODE"),
    (179, "DO_SET_HOME"),
    (181, "DO_SET_RELAY"),
    (182, "DO_REPEAT_RELAY"),
    (183, "DO_SET_SERVO"),
    (184, "DO_REPEAT_SERVO"),
    (191, "DO_GO_AROUND"),
    (195, "DO_SET_ROI_LOCATION"),
    (196, "DO_SET_ROI_WPNEXT_OFFSET"),
    (197, "DO_SET_ROI_NONE"),
    (201, "DO_SET_ROI"),
    (202, "DO_DIGICAM_CONFIGURE"),
    (204, "DO_MOUNT_CONFIGURE"),
    (205, "DO_MOUNT_CONTROL"),
    (207, "DO_FENCE_ENABLE"),
    (208, "DO_PARACHUTE"),
    (210, "DO_INVERTED_FLIGHT"),
    (211, "DO_GRIPPER"),
    (212, "DO_AUTOTUNE_ENABLE"),
    (214, "DO_SET_CAM_TRIGG_INTERVAL"),
    (222, "DO_GUIDED_LIMITS"),
    (223, "DO_ENGINE_CONTROL"),
    (530, "SET_CAMERA_MODE"),
    (600, "JUMP_TAG"),
    (601, "DO_JUMP_TAG"),
    (1000, "DO_GIMBAL_MANAGER_PITCHYAW"),
    (3000, "DO_VTOL_TRANSITION"),
];

/// What people call a command that is not carried over: `command 183 (DO_SET_SERVO)`.
pub fn shown(command: u16) -> String {
    match DESCRIBED.iter().find(|(number, _)| *number == command) {
        Some((number, name)) => format!("command {number} ({name})"),
        // what a file has beyond it is kept as it
        None if command == u16::MAX => "a command that MAVLink doesn't have".to_owned(),
        None => format!("command {command}"),
    }
}
