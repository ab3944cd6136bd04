//! What `--help` says below the options: examples and exit statuses.

macro_rules! with_examples {
    ($($line:literal),* $(,)?) => {
        concat!(
            "Examples:\n",
            $("  ", $line, "\n",)*
            "\nExit status:\n",
            "  0  fine; warnings and notes are allowed\n",
            "  1  the plan or its path has errors, can't be flown, or plans differ; nothing of another program's file is a plan\n",
            "  2  wrong usage, or a file that can't be read or written\n",
            "\nFormats:\n",
            "  xml (Legwork), plan (QGroundControl), waypoints (QGC WPL 110), kml, kmz, geojson, gpx; csv is only written,\n  fpxml (XML with <MainFP> and TFLeg, IterativeLeg, IntersectionLeg, Scan) only read.\n",
            "  Both kinds of csv begin with number or token, leg, position, altitude, airspeed, action, fly_over: `expand` lists what is\n",
            "  sent (also waypoints that are replaced before they are reached) and when the aircraft steers to them; `convert` what is flown, by passage.\n",
            "  Formats are found by content and name. `-` is standard input or output. Nothing is overwritten without --force."
        )
    };
}

pub const CHECK: &str = with_examples!(
    "legwork check fire-watch.xml",
    "legwork check --json survey.plan --runway 36.319,-84.173,349,52,600",
    "cat fire-watch.xml | legwork check -",
);

pub const PREVIEW: &str = with_examples!(
    "legwork preview fire-watch.xml --out pictures --wind 270,5",
    "legwork preview fire-watch.xml --decide ask=close --set fire_radius=500",
    "legwork preview fire-watch.xml --autopilot arduplane,90 --wind 270,5",
    "legwork preview fire-watch.xml --emergency north-strip --at sweep --json",
);

pub const EXPAND: &str = with_examples!(
    "legwork expand fire-watch.xml > waypoints.csv",
    "legwork expand fire-watch.xml --emergency return -o return.waypoints",
    "legwork expand fire-watch.xml --to geojson | other-program",
);

pub const CONVERT: &str = with_examples!(
    "legwork convert survey.plan survey.xml",
    "legwork convert fire-watch.xml fire-watch.plan",
    "legwork convert route.gpx route.xml --runway 36.319,-84.173,349,52,600 --height 120",
    "legwork convert no-fly.kml no-fly.xml --areas keep-out",
    "legwork convert fire-watch.xml - --to waypoints --emergency north-strip --at sweep",
);

pub const DIFF: &str = with_examples!(
    "legwork diff fire-watch.xml fire-watch-2.xml",
    "legwork diff fire-watch.xml fire-watch-2.xml --at sweep --pass 2 --json",
);

pub const LOG: &str = concat!(
    "Examples:\n",
    "  legwork log recordings/*.mcap\n",
    "  legwork log --check uav1-20261123T080000Z-001.mcap\n",
    "  legwork log --export flight.gpx uav1-20261123T080000Z-001.mcap\n",
    "\nExit status:\n",
    "  0  fine\n",
    "  1  a file is no recording, or with --check: torn or damaged; what can be read of it is given\n",
    "  2  wrong usage, or a file that can't be read or written",
);
