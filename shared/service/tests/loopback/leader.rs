//! A service with an adapter that leads the simulated time, and one that asks others while it follows it.

use super::{DEADLINE, free_endpoint, within};
use service::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};
use usal::contract::Stamped;
use usal::topics::{Events, Invocation};
use usal::{Conductor, Occurrence, Participant, Said, Session, Spec, Start};

const STEPS: Events<Stamped<f64>> = Events::new("metronome", "steps");

/// Leads the time to where the world says.
#[derive(Default)]
struct Metronome {
    waited: Arc<AtomicU32>,
}

enum Input {
    Started,
    Step(Duration),
    Stepped(Duration),
    Waiting,
    Broken,
    Ended,
}

impl Service for Metronome {
    type Input = Input;
    type Output = &'static str;
    const SPEC: Spec = Spec { name: "metronome", about: "leads", says: &[Said::events(STEPS)] };

    fn wire(wiring: &mut Wiring<Input>) {
        wiring.started(|| Input::Started);
        wiring.stepped(Input::Stepped);
        wiring.waiting(|_| Input::Waiting);
        wiring.ended(|| Input::Ended);
    }

    fn step(&mut self, now: Time, input: Input, out: &mut Out<Input, &'static str>) {
        match input {
            Input::Started => out.push("open"),
            Input::Step(to) => out.lead_time_to(to),
            Input::Stepped(to) => {
                assert_eq!(to, now);
                out.push("play");
                out.emit(STEPS, 1.0, to.as_secs_f64());
            }
            Input::Waiting => drop(self.waited.fetch_add(1, Ordering::Relaxed)),
            Input::Broken => out.fail(anyhow::anyhow!("a string broke")),
            Input::Ended => out.push("close"),
        }
    }
}

/// What the adapter was told to do, whether something waits for it, and what lets it be done.
type Performed = (Vec<&'static str>, bool, oneshot::Sender<()>);

/// The adapter: the test is the world.
struct World {
    happens: mpsc::UnboundedReceiver<Input>,
    performed: mpsc::UnboundedSender<Performed>,
}

impl Adapter<Metronome> for World {
    async fn next(&mut self) -> Input {
        match self.happens.recv().await {
            Some(input) => input,
            None => std::future::pending().await,
        }
    }

    async fn perform(&mut self, _: Time, outputs: Vec<&'static str>, leaves: bool, _: &mut Tasks<Input>) {
        let (release, released) = oneshot::channel();
        let _ = self.performed.send((outputs, leaves, release));
        let _ = released.await;
    }

    async fn finish(&mut self) {
        let _ = self.performed.send((vec!["finish"], false, oneshot::channel().0));
    }
}

/// The metronome in its world, which is also the vehicle's hub.
struct Stage {
    endpoint: String,
    happens: mpsc::UnboundedSender<Input>,
    performed: mpsc::UnboundedReceiver<Performed>,
    waited: Arc<AtomicU32>,
    trigger: Trigger,
    task: tokio::task::JoinHandle<anyhow::Result<()>>,
}

impl Stage {
    fn open() -> Self {
        let endpoint = free_endpoint();
        let (happens, world) = mpsc::unbounded_channel();
        let (sender, performed) = mpsc::unbounded_channel();
        let metronome = Metronome::default();
        let waited = metronome.waited.clone();
        let role = usal::Role::Hub { listen: endpoint.clone() };
        let config = Config { role, timing: Timing::Leads, ..Config::client("uav1", "") };
        let (trigger, end) = shutdown();
        let made = async move |_: Beginning| Ok((metronome, World { happens: world, performed: sender }));
        let task = tokio::spawn(run(config, end, made));
        Self { endpoint, happens, performed, waited, trigger, task }
    }

    /// What the adapter does next; it is held up until the last part is sent to or dropped.
    async fn performs(&mut self) -> Performed {
        within(self.performed.recv()).await.unwrap()
    }

    async fn expect(&mut self, expected: &str) {
        let (outputs, leaves, _release) = self.performs().await;
        assert_eq!((outputs, leaves), (vec![expected], false));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn time_that_is_led_waits_for_who_follows_and_events_for_the_adapter() {
    let mut stage = Stage::open();
    stage.expect("open").await;
    let client = Session::open(usal::Config::client("uav1", &stage.endpoint).named("tester")).await.unwrap();
    let mut steps = client.listen(STEPS, Start::Remembered).unwrap();
    let mut follower = Participant::join(&client, "tester").unwrap();
    let mut number = 0;
    // the leader learns of the follower sooner or later, and from then on time stands until it is done
    let (led_s, (outputs, leaves, release)) = within(async {
        loop {
            number += 1;
            stage.happens.send(Input::Step(Duration::from_secs(number))).ok().unwrap();
            let present = async {
                loop {
                    let tick = follower.next().await.unwrap();
                    if tick.time_s >= number as f64 {
                        return tick;
                    }
                }
            };
            let early = tokio::select! {
                tick = present => {
                    let early = tokio::time::timeout(Duration::from_millis(200), stage.performed.recv()).await;
                    follower.acknowledge(tick);
                    match early {
                        Ok(early) => early.unwrap(),
                        Err(_) => return (tick.time_s, stage.performs().await),
                    }
                }
                early = stage.performed.recv() => early.unwrap(),
            };
            drop(early);
        }
    })
    .await;
    assert_eq!((led_s, outputs, leaves), (number as f64, vec!["play"], true));
    // the event of this step waits for the adapter
    while let Some(earlier) = steps.try_recv() {
        assert!(matches!(earlier, Occurrence::Event { event, .. } if event.value < led_s));
    }
    release.send(()).unwrap();
    let told = within(async {
        loop {
            match steps.recv().await.unwrap() {
                Occurrence::Event { event, .. } if event.value < led_s => {}
                told => return told,
            }
        }
    })
    .await;
    let expected = Stamped { time_s: led_s, validity_s: 1.0, value: led_s };
    assert!(matches!(told, Occurrence::Event { event, .. } if event == expected));
    // while the world does nothing, the leader hears that time stands
    let before = stage.waited.load(Ordering::Relaxed);
    within(async {
        while stage.waited.load(Ordering::Relaxed) < before + 3 {
            tokio::task::yield_now().await;
        }
    })
    .await;
    stage.trigger.shut_down();
    stage.expect("close").await;
    stage.expect("finish").await;
    within(stage.task).await.unwrap().unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn service_that_fails_ends_in_order_with_its_reason() {
    let mut stage = Stage::open();
    stage.expect("open").await;
    stage.happens.send(Input::Broken).ok().unwrap();
    stage.expect("close").await;
    stage.expect("finish").await;
    let error = within(stage.task).await.unwrap().unwrap_err();
    assert_eq!(error.to_string(), "a string broke");
}

const ECHO: Invocation<f64, f64> = Invocation::new("echo", "echo");
const HEARD: Events<Stamped<f64>> = Events::new("asker", "heard");

/// Asks at each tick what time it is.
struct Asker;

enum Asked {
    Tick,
    Answered(Option<f64>),
}

impl Service for Asker {
    type Input = Asked;
    type Output = Never;
    const SPEC: Spec = Spec { name: "asker", about: "asks", says: &[Said::events(HEARD)] };

    fn wire(wiring: &mut Wiring<Asked>) {
        wiring.tick(|| Asked::Tick);
    }

    fn step(&mut self, now: Time, input: Asked, out: &mut Out<Asked>) {
        match input {
            Asked::Tick => out.call(ECHO, now.as_secs_f64(), DEADLINE, |answer| Asked::Answered(answer.ok())),
            Asked::Answered(answer) => out.emit(HEARD, 1.0, answer.unwrap_or(f64::NAN)),
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn answers_of_others_take_no_simulated_time() {
    let endpoint = free_endpoint();
    let hub = Session::open(usal::Config::hub("uav1", &endpoint).named("echo")).await.unwrap();
    let mut server = hub.serve(ECHO).unwrap();
    let mut conductor = Conductor::new(&hub).unwrap().patience(DEADLINE);
    let mut heard = hub.listen(HEARD, Start::Remembered).unwrap();
    let (trigger, end) = shutdown();
    let config = Config { timing: Timing::Follows, ..Config::client("uav1", &endpoint) };
    let task = tokio::spawn(run_alone(config, Asker, end));
    within(async {
        while conductor.participants() != ["asker"] {
            tokio::task::yield_now().await;
        }
    })
    .await;
    for time_s in [1.0, 2.0, 3.0] {
        conductor.start(time_s);
        let (asked_s, answer) = within(server.recv()).await.unwrap().split();
        let early = tokio::time::timeout(Duration::from_millis(100), conductor.settle()).await;
        assert!(early.is_err() && heard.try_recv().is_none(), "time stands until the answer is there");
        answer(Ok(asked_s));
        assert!(within(conductor.settle()).await.is_empty());
        let Occurrence::Event { event, .. } = within(heard.recv()).await.unwrap() else { panic!("a gap") };
        assert_eq!(event, Stamped { time_s, validity_s: 1.0, value: time_s });
    }
    trigger.shut_down();
    within(task).await.unwrap().unwrap();
}
