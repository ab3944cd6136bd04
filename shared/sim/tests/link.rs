//! The shell on loopback: real sockets, the real binary. Waits are on conditions, with deadlines.
#![cfg(test)]

use mavlink::dialects::ardupilotmega::*;
use sim::frame::{Body, Decoder, Sender, encode_from, take_frames};
use sim::{Config, Control, Handle, Link, Mode, Personality};
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const GROUND: Sender = Sender { system: 255, component: 190 };
const DEADLINE: Duration = Duration::from_secs(20);

fn loopback() -> SocketAddr {
    ([127, 0, 0, 1], 0).into()
}

/// A TCP ground station.
struct Client {
    stream: TcpStream,
    decoder: Decoder,
    sequence: u8,
}

impl Client {
    fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(200))).unwrap();
        stream.set_nodelay(true).unwrap();
        Self { stream, decoder: Decoder::default(), sequence: 0 }
    }

    fn say(&mut self, message: &MavMessage) {
        self.sequence = self.sequence.wrapping_add(1);
        self.stream.write_all(&encode_from(GROUND, self.sequence, message)).unwrap();
    }

    /// What has come by now; waits a little if nothing has.
    fn receive(&mut self) -> Vec<MavMessage> {
        let (mut buffer, mut received) = ([0_u8; 8192], Vec::new());
        match self.stream.read(&mut buffer) {
            Ok(0) => panic!("the simulator hung up"),
            Ok(n) => {
                self.decoder.push(&buffer[..n]);
                for frame in take_frames(&mut self.decoder) {
                    if let Body::Known(m) = frame.body {
                        received.push(*m);
                    }
                }
            }
            Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(e) => panic!("{e}"),
        }
        received
    }

    /// Receives until something passes the test.
    fn receive_until(&mut self, what: &str, mut test: impl FnMut(&MavMessage) -> bool) {
        let deadline = Instant::now() + DEADLINE;
        while Instant::now() < deadline {
            if self.receive().iter().any(&mut test) {
                return;
            }
        }
        panic!("never received {what}");
    }

    /// Answers every lockstep question until the simulated time; gives the number of questions.
    fn drive_until(&mut self, time_s: f64) -> u32 {
        let (deadline, mut questions) = (Instant::now() + DEADLINE, 0);
        while Instant::now() < deadline {
            for message in self.receive() {
                let MavMessage::TIMESYNC(t) = message else { continue };
                if t.tc1 == 0 {
                    questions += 1;
                    self.say(&timesync(1, t.ts1));
                    if t.ts1 as f64 / 1e9 >= time_s {
                        return questions;
                    }
                }
            }
        }
        panic!("simulated time never came to {time_s}");
    }
}

fn timesync(tc1: i64, ts1: i64) -> MavMessage {
    MavMessage::TIMESYNC(TIMESYNC_DATA { tc1, ts1, ..TIMESYNC_DATA::DEFAULT })
}

fn command(command: MavCmd, param1: f32, param2: f32) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1,
        param2,
        command,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::DEFAULT
    })
}

fn lockstep(speed: f64) -> Handle {
    let config = Config { speed, lockstep: true, ..Config::default() };
    sim::spawn(config).unwrap()
}

fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    let deadline = Instant::now() + DEADLINE;
    while !condition() {
        assert!(Instant::now() < deadline, "waited in vain: {what}");
        std::thread::yield_now();
    }
}

#[test]
fn in_lockstep_the_partner_drives_time_and_nobody_else() {
    let handle = lockstep(0.0);
    let mut client = Client::connect(handle.address());
    let began = Instant::now();
    let questions = client.drive_until(120.0);
    let took = began.elapsed();
    assert!((1_000..=1_210).contains(&questions), "{questions}");
    assert!(took < Duration::from_secs(15), "{took:?} for two minutes");
    // the last answer allows one more step, and no more
    wait_for("the last step", || handle.truth().time_s >= 120.05);
    let stopped = handle.truth();
    assert!(stopped.lockstep && stopped.time_s < 120.15, "{stopped:?}");
    client.say(&timesync(1, 5));
    client.say(&command(MavCmd::MAV_CMD_REQUEST_MESSAGE, 148.0, 0.0));
    client.receive_until("the version", |m| matches!(m, MavMessage::AUTOPILOT_VERSION(_)));
    assert_eq!(handle.truth().time_s, stopped.time_s, "an old answer moved time");
}

#[test]
fn a_lockstep_partner_that_leaves_is_not_waited_for() {
    let handle = lockstep(0.0);
    let mut client = Client::connect(handle.address());
    client.drive_until(30.0);
    drop(client);
    let left = handle.truth().time_s;
    wait_for("real time to go on", || handle.truth().time_s > left + 0.5);
    assert!(!handle.truth().lockstep);
    let mut next = Client::connect(handle.address());
    next.drive_until(60.0);
    assert!(handle.truth().lockstep);
}

/// Its clock stands at zero: what came before the time would seem to be as old as the simulation.
#[test]
fn who_comes_hears_first_how_late_it_is() {
    let handle = lockstep(0.0);
    wait_for("time to go on", || handle.truth().time_s > 0.5);
    let mut client = Client::connect(handle.address());
    let mut first = None;
    wait_for("the first message", || {
        first = client.receive().into_iter().next();
        first.is_some()
    });
    assert!(
        matches!(&first, Some(MavMessage::TIMESYNC(t)) if t.tc1 == 0 && t.ts1 > 500_000_000),
        "{first:?}"
    );
}

#[test]
fn without_lockstep_time_runs_at_its_speed() {
    let handle = sim::spawn(Config { speed: 20.0, ..Config::default() }).unwrap();
    let began = Instant::now();
    wait_for("ten simulated seconds", || handle.truth().time_s >= 10.0);
    let took = began.elapsed().as_secs_f64();
    assert!(took > 0.4, "{took} s of the wall for 10 s at 20 times: too fast");
}

#[test]
fn garbage_on_tcp_is_counted_and_a_second_client_is_turned_away() {
    let handle = sim::spawn(Config::default()).unwrap();
    let mut client = Client::connect(handle.address());
    client.stream.write_all(&[0xAA; 5000]).unwrap();
    client.say(&command(MavCmd::MAV_CMD_REQUEST_MESSAGE, 242.0, 0.0));
    client.receive_until("home", |m| matches!(m, MavMessage::HOME_POSITION(_)));
    wait_for("the count", || handle.truth().ignored_bytes == 5000);
    let mut second = TcpStream::connect(handle.address()).unwrap();
    second.set_read_timeout(Some(DEADLINE)).unwrap();
    // closed, or reset: nothing but an end comes
    assert!(matches!(second.read(&mut [0; 16]), Ok(0) | Err(_)));
    client.receive_until("a heartbeat", |m| matches!(m, MavMessage::HEARTBEAT(_)));
}

#[test]
fn a_client_that_never_reads_does_not_stop_time() {
    let handle = sim::spawn(Config { speed: 20.0, ..Config::default() }).unwrap();
    let mut client = Client::connect(handle.address());
    // some 19 MB of answers: more than the sockets' buffers and the simulator's own
    let ask =
        MavMessage::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA { target_system: 1, target_component: 1 });
    for _ in 0..25_000 {
        client.say(&ask);
    }
    let asked = handle.truth().time_s;
    wait_for("time to go on", || handle.truth().time_s > asked + 5.0);
    // and what it reads in the end is still made of whole frames
    client.receive_until("a late heartbeat", |m| matches!(m, MavMessage::HEARTBEAT(_)));
    client.receive_until(
        "time",
        |m| matches!(m, MavMessage::SYSTEM_TIME(t) if f64::from(t.time_boot_ms) / 1e3 > asked + 5.0),
    );
    assert_eq!(client.decoder.ignored_bytes, 0);
}

#[test]
fn several_udp_partners_are_served_and_strangers_bytes_are_not_answered() {
    let config = Config { link: Link::Udp(loopback()), speed: 10.0, ..Config::default() };
    let handle = sim::spawn(config).unwrap();
    let receives = |socket: &UdpSocket| {
        let mut buffer = [0; 512];
        socket.recv_from(&mut buffer).is_ok_and(|(n, _)| n > 10)
    };
    let open = |timeout_ms| {
        let socket = UdpSocket::bind(loopback()).unwrap();
        socket.set_read_timeout(Some(Duration::from_millis(timeout_ms))).unwrap();
        socket
    };
    let partners = [open(5000), open(5000)];
    let stranger = open(300);
    stranger.send_to(&[0xFD; 30], handle.address()).unwrap();
    for socket in &partners {
        let heartbeat = encode_from(GROUND, 0, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::DEFAULT));
        socket.send_to(&heartbeat, handle.address()).unwrap();
    }
    assert!(partners.iter().all(receives));
    assert!(!receives(&stranger));
    assert_eq!(handle.truth().ignored_bytes, 30);
}

#[test]
fn udp_out_sends_from_the_start() {
    let socket = UdpSocket::bind(loopback()).unwrap();
    socket.set_read_timeout(Some(DEADLINE)).unwrap();
    let link = Link::UdpOut(socket.local_addr().unwrap());
    let handle = sim::spawn(Config { link, ..Config::default() }).unwrap();
    let mut buffer = [0; 512];
    let (n, from) = socket.recv_from(&mut buffer).unwrap();
    assert!(n > 10);
    assert_eq!(from, handle.address());
}

#[test]
fn an_address_in_use_is_an_error_that_says_what_to_do() {
    let first = sim::spawn(Config::default()).unwrap();
    let link = Link::Tcp(first.address());
    let error = sim::spawn(Config { link, ..Config::default() }).unwrap_err();
    assert!(format!("{error:#}").contains("choose another port"), "{error:#}");
}

#[test]
fn a_parameter_that_the_autopilot_does_not_have_is_an_error_that_names_both() {
    let with = |params: &[(&str, f32)]| {
        let params = params.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        sim::spawn(Config { personality: Personality::Px4, params, ..Config::default() })
    };
    assert!(with(&[("MIS_TKO_LAND_REQ", 0.0)]).is_ok());
    for wrong in [("RTL_ALTITUDE", 50.0), ("MIS_TKO_LAND_REQ", 99.0)] {
        let error = with(&[wrong]).unwrap_err().to_string();
        assert!(error.contains(wrong.0) && error.contains("px4"), "{error}");
    }
}

#[test]
fn faults_and_the_track_log_through_the_handle() {
    let handle = lockstep(0.0);
    let mut client = Client::connect(handle.address());
    assert!(handle.control(Control::Inject("low-battery".parse().unwrap())));
    client.drive_until(20.0);
    assert!(handle.truth().battery < 0.16);
    assert_eq!(handle.truth().mode, Mode::Manual);
    let track = handle.take_track();
    assert!(track.len() >= 35, "{}", track.len());
    assert!(track.windows(2).all(|w| w[1].time_s > w[0].time_s + 0.4));
    handle.stop();
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_on_a_full_disk_is_exit_status_2() {
    for arguments in [&["--help"][..], &["--tcp", "127.0.0.1:0"]] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let run = Command::new(env!("CARGO_BIN_EXE_legwork-sim"))
            .args(arguments)
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(run.status.code() == Some(2) && said.contains("standard output can't be written"), "{said}");
    }
}

#[test]
fn the_binary_prints_its_address_and_obeys_lines() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_legwork-sim"))
        .args(["--tcp", "127.0.0.1:0", "--wind", "270,5", "--seed", "9", "--fault", "gps-loss"])
        .args(["--personality", "arduplane", "--param", "WP_LOITER_RAD=150"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        // a file, so that its log is not in the way of what the tests print
        .stderr(File::create(concat!(env!("CARGO_TARGET_TMPDIR"), "/legwork-sim.log")).unwrap())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    assert_eq!(lines.next().unwrap(), "seed 9");
    let listening = lines.next().unwrap();
    let address = listening.strip_prefix("listening on tcp ").unwrap().parse().unwrap();
    let mut client = Client::connect(address);
    client.receive_until(
        "the lost fix",
        |m| matches!(m, MavMessage::GPS_RAW_INT(g) if g.fix_type == GpsFixType::GPS_FIX_TYPE_NO_FIX),
    );
    let mut stdin = child.stdin.take().unwrap();
    writeln!(stdin, "clear gps-loss\ndance\nwind 90,3").unwrap();
    client.receive_until(
        "the fix",
        |m| matches!(m, MavMessage::GPS_RAW_INT(g) if g.fix_type == GpsFixType::GPS_FIX_TYPE_3D_FIX),
    );
    client.receive_until("the new wind", |m| matches!(m, MavMessage::WIND(w) if w.speed == 3.0));
    assert_eq!(lines.next().unwrap(), "ok clear gps-loss");
    assert!(lines.next().unwrap().starts_with("error \"dance\""));
    writeln!(stdin, "stop").unwrap();
    assert!(child.wait().unwrap().success());
}
