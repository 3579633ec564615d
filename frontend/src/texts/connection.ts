/** Texts about the connection to the robot, and why commands or requests are refused. */
export const connection = {
  hops: {
    page: 'This page',
    server: 'Server',
    runtime: 'Runtime',
    board: 'Board',
    serverSilent: 'The server does not answer',
    untrusted: 'The live connection does not open',
    trustIt: 'This device does not trust the robot’s certificate for it. Trust the certificate first: Help, Access, TLS. STOP works meanwhile.',
    serverEnded: 'The server ended the connection',
    pageReconnects:
      'The page reconnects by itself. If it does not, check that the robot is switched on, that its server runs and that this device is in its network.',
    runtimeStarting: 'The runtime is starting',
    runtimeSilent: 'The runtime does not answer the server',
    boardReserved: 'The robot’s board is at other work',
    noData: 'No data from it for a while',
    serverRestarts: 'The server restarts it by itself. System has the details.',
    boardSilent: 'The board does not answer the runtime',
    runtimeReconnects: 'The runtime reconnects by itself. Without commands the fins rest and the robot floats up.',
  },
  barred: {
    unknown: 'It is not known yet who has control.',
    viewer: 'Viewers can watch and press STOP.',
    nobody: 'Nobody has control. Take control first.',
    other: (name: string) => `${name} has control. Take over first.`,
    replay: 'This is a replay. The robot cannot be commanded here.',
  },
  requests: {
    noAnswer: 'The server does not answer. Check that it runs and that this device is in its network.',
    uploadFailed: (file: string) => `${file} was not uploaded completely. Check that the server runs, then try again.`,
    downloadFailed: 'The download was interrupted. Check that the server runs and that this device is in its network.',
    noReason: (status: number) => `The server refused with status ${status} and gave no reason. Try again. The server’s log may tell more.`,
  },
} as const;
