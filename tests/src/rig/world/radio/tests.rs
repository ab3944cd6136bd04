//! The radio between two sockets.

use super::*;
use autopilot_link::frame::{Sender, encode};
use mavlink::dialects::ardupilotmega::*;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpStream, UdpSocket};

const AUTOPILOT: Sender = Sender { system: 1, component: 1 };
const PATIENCE: Duration = Duration::from_secs(20);

/// An autopilot and an agent with a radio between them.
struct Ends {
    radio: Radio,
    autopilot: UdpSocket,
    agent: TcpStream,
    decoder: Decoder,
}

impl Ends {
    async fn open(conditions: Vec<Control>) -> Self {
        let own = std::net::UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let radio = Radio::open(&format!("udp:{own}").parse().unwrap(), conditions, 7).await.unwrap();
        let autopilot = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        autopilot.connect(own).await.unwrap();
        let agent = TcpStream::connect(radio.address).await.unwrap();
        Self { radio, autopilot, agent, decoder: Decoder::default() }
    }

    /// The autopilot says a number.
    async fn says(&self, custom_mode: u32) {
        let heartbeat = HEARTBEAT_DATA {
            custom_mode,
            autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
            ..Default::default()
        };
        self.autopilot.send(&encode(AUTOPILOT, 0, &MavMessage::HEARTBEAT(heartbeat))).await.unwrap();
    }

    /// The number that the agent hears next.
    async fn hears(&mut self) -> u32 {
        let mut bytes = [0; 300];
        loop {
            if let Some(frame) = self.decoder.next_frame() {
                let Some(MavMessage::HEARTBEAT(heartbeat)) = frame.message() else { panic!("{frame:?}") };
                return heartbeat.custom_mode;
            }
            let read = tokio::time::timeout(PATIENCE, self.agent.read(&mut bytes)).await.unwrap().unwrap();
            self.decoder.push(&bytes[..read]);
        }
    }

    /// What the autopilot is told next.
    async fn is_told(&self) -> MavMessage {
        let mut bytes = [0; 300];
        let read = tokio::time::timeout(PATIENCE, self.autopilot.recv(&mut bytes)).await.unwrap().unwrap();
        let mut decoder = Decoder::default();
        decoder.push_datagram(&bytes[..read]);
        decoder.next_frame().unwrap().message().unwrap()
    }

    /// It confirms what it is told next, which may have been said again; its name.
    async fn confirms(&self) -> String {
        let (name, answer) = match self.is_told().await {
            MavMessage::PARAM_SET(PARAM_SET_DATA { param_id, param_value, .. }) => {
                let value = PARAM_VALUE_DATA { param_id, param_value, ..Default::default() };
                (param_id.to_str().unwrap().to_owned(), MavMessage::PARAM_VALUE(value))
            }
            MavMessage::COMMAND_LONG(COMMAND_LONG_DATA { command, .. }) => {
                let ack = COMMAND_ACK_DATA { command, ..Default::default() };
                (format!("{command:?}"), MavMessage::COMMAND_ACK(ack))
            }
            other => panic!("{other:?}"),
        };
        self.autopilot.send(&encode(AUTOPILOT, 0, &answer)).await.unwrap();
        name
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_said_while_the_radio_is_silent_is_never_heard() {
    let mut ends = Ends::open(vec!["fault silence".parse().unwrap()]).await;
    ends.says(1).await;
    // the voice is no radio: it speaks when it has heard that
    ends.is_told().await;
    ends.radio.tell("clear silence".parse().unwrap()).unwrap();
    while ends.radio.controls.as_ref().unwrap().capacity() < MAX_CONTROLS {
        tokio::task::yield_now().await;
    }
    ends.says(2).await;
    assert_eq!(ends.hears().await, 2);
    ends.agent
        .write_all(&encode(AUTOPILOT, 0, &MavMessage::TIMESYNC(TIMESYNC_DATA::default())))
        .await
        .unwrap();
    while !matches!(ends.is_told().await, MavMessage::TIMESYNC(_)) {}
}

#[tokio::test(flavor = "multi_thread")]
async fn the_world_is_put_right_before_it_is_disturbed() {
    let conditions = ["wind 270,5", "fault gps-loss"].map(|line| line.parse().unwrap());
    let mut ends = Ends::open(conditions.into()).await;
    ends.says(1).await;
    let (wind, gps) = (["SIM_WIND_DIR", "SIM_WIND_SPD"], ["SIM_GPS1_ENABLE"]);
    let right =
        [&wind[..], &gps, &["SIM_ENGINE_FAIL", "THR_MAX", "MAV_CMD_BATTERY_RESET", "FENCE_ENABLE"]].concat();
    let mut told: Vec<String> = vec![];
    while told.len() < right.len() + wind.len() + gps.len() {
        told.push(ends.confirms().await);
        told.dedup();
    }
    assert_eq!(told, [&right[..], &wind, &gps].concat());
    tokio::time::timeout(PATIENCE, ends.radio.state.wait_for(|state| state.is_as_asked))
        .await
        .unwrap()
        .unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn address_is_free_when_the_radio_is_gone() {
    let own = std::net::UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    for _ in 0..3 {
        Radio::open(&format!("udp:{own}").parse().unwrap(), vec![], 1).await.unwrap();
    }
}
