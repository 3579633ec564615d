/** Texts of the guided first dive. What is to be pressed or read stands between ** and **, by its own name. */
import { pages } from './pages';

const SAME = 'the same.';

export const guide = {
  title: 'First dive',
  simulated: 'Simulated water',
  count: (number: number, all: number) => `${number} of ${all}`,
  ticked: (step: string) => `Done: ${step}`,
  onRobot: 'On a robot:',
  show: 'Show me',
  goTo: (page: string) => `Go to ${page}`,
  skip: 'Skip',
  fold: 'Less',
  unfold: 'More',
  end: 'Do not show again',
  steps: {
    look: {
      title: 'Look at it',
      text: 'The robot’s real firmware runs on an emulated chip, in simulated water: nothing can break. In the panel **Camera**, press **bystander** to see the robot from outside.',
      robot: 'you see what its own camera sees.',
    },
    dive: {
      title: 'Dive',
      text: 'Hold **Hold to arm** for a second. The robot dives to 0.5 m, swings about that depth, and records.',
      robot: 'weigh and trim it first, keep hands off the fins, and hold it by a line.',
    },
    card: {
      title: 'Show it a card',
      text: 'In the panel **Camera**, press **robot**, then **yellow**. Its camera sees the card, and the robot follows to 1.0 m.',
      robot: 'hold a card or a marker in front of its camera. Under water nothing else commands it.',
    },
    controller: {
      title: 'Choose another controller',
      text: 'In the panel **Depth controller**, choose **Model-based** and press **Apply**. The swinging ends.',
      robot: 'identify its craft first: the model must be of your robot.',
    },
    mark: {
      title: 'Mark a moment',
      text: 'Press the key **M**. Without keys: the red lamp in the bar, then “Mark this moment”.',
      robot: SAME,
    },
    stop: {
      title: 'Stop',
      text: 'Press **STOP**, or Esc. The fins stop, and the robot floats up. Its recording ends 5 s later.',
      robot: 'it rises since it is a little lighter than water. That is why you weigh it.',
    },
    mission: {
      title: 'Dive without Wi-Fi',
      text: 'On the page **Missions**, open **Two depths** and hold **Hold to start the mission**. From then on it needs neither Wi-Fi nor this page.',
      robot: 'no Wi-Fi reaches it under water. Begin at the edge, with the mission First dive: it waits until it is wet.',
    },
    story: {
      title: 'Read its story',
      text: 'On the page **Sessions**, open a session by its name: depth over time, what happened and when, and the figures.',
      robot: 'the recording waits on board until Wi-Fi is back.',
    },
    compare: {
      title: 'Compare two dives',
      text: 'On the page **Sessions**, tick two sessions and press **Compare 2**.',
      robot: SAME,
    },
    export: {
      title: 'Take the data with you',
      text: 'Open a session, its tab **Data**, and press **Create file**: one table for each topic.',
      robot: SAME,
    },
  },
  acknowledge: {
    title: 'Acknowledge the stop',
    text: 'The robot stopped by itself. On the page **Operate**, read why, and press **Acknowledge**.',
    robot: 'see to the cause first.',
  },
  disarmed: 'The robot is disarmed.',
  finished: {
    title: 'You have dived',
    text: 'Go on as you like: drive by hand, write a mission, run an experiment many times.',
    links: { flight: pages.flight, missions: pages.missions, scenarios: pages.scenarios },
    close: 'Close',
  },
} as const;
