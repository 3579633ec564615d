// Does with an unmodified roslib what a page does: `node roslib.mjs roslib|roslib-1 ADDRESS`, prints JSON.
// The address holds a token that may operate; the robot is stopped at the end.
const [name, address, viewer] = process.argv.slice(2)
const module = await import(name)
const ROSLIB = module.default ?? module
if (name === 'roslib') globalThis.WebSocket ??= (await import('ws')).WebSocket
const connect = (url) =>
  new Promise((done, fail) => {
    const ros = new ROSLIB.Ros({ url })
    ros.on('connection', () => done(ros))
    ros.on('error', fail)
  })
const ros = await connect(address)
const topic = (on, topicName, messageType, more = {}) =>
  new ROSLIB.Topic({ ros: on, name: topicName, messageType, ...more })
const first = (one) => new Promise((done) => one.subscribe(done))
const call = (on, service, args = {}) =>
  new Promise((done) => {
    const asked = new ROSLIB.Service({ ros: on, name: service, serviceType: '' })
    const request = ROSLIB.ServiceRequest ? new ROSLIB.ServiceRequest(args) : args
    asked.callService(request, (values) => done({ values }), (problem) => done({ problem: String(problem) }))
  })
const said = {}
said.topics = await new Promise((done, fail) => ros.getTopics(done, fail))
said.services = await new Promise((done, fail) => ros.getServices(done, fail))
said.type = await new Promise((done, fail) => ros.getTopicType('/imu/data', done, fail))
said.parameters = await new Promise((done, fail) => ros.getParams(done, fail))
const everything = said.topics.topics.map((one, place) => topic(ros, one, said.topics.types[place]))
for (const one of everything) if (!['/cmd_vel', '/mucat/stop'].includes(one.name)) one.subscribe(() => {})
said.imu = await first(topic(ros, '/imu/data', 'sensor_msgs/Imu', { throttle_rate: 50, queue_length: 1 }))
for (const one of everything) if (one.name !== '/cmd_vel') one.unsubscribe()
const packed = await connect(address)
said.cbor = await first(topic(packed, '/mucat/depth', 'mucat/msg/Depth', { compression: 'cbor' }))
said.png = await first(topic(await connect(address), '/pressure', 'sensor_msgs/FluidPressure', { compression: 'png' }))
const looking = await connect(viewer)
said.refused = await call(looking, '/mucat/take_control')
said.before = await call(ros, '/mucat/arm', { mode: 'manual' })
said.taken = await call(ros, '/mucat/take_control', { over: true })
said.acknowledged = await call(ros, '/mucat/acknowledge')
said.armed = await call(ros, '/mucat/arm', { mode: 'manual' })
const twist = { linear: { x: 0.5, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 0.25 } }
const sticks = topic(ros, '/cmd_vel', 'geometry_msgs/Twist')
sticks.advertise()
const driven = new Promise((done) => {
  topic(ros, '/mucat/navigation', 'mucat/msg/Navigation').subscribe((one) => one.x !== 0 && done(one))
})
const driving = setInterval(() => sticks.publish(ROSLIB.Message ? new ROSLIB.Message(twist) : twist), 50)
said.driven = await driven
clearInterval(driving)
topic(looking, '/mucat/stop', 'std_msgs/Empty').publish(ROSLIB.Message ? new ROSLIB.Message({}) : {})
said.stopped = await new Promise((done) => {
  topic(ros, '/mucat/state', 'mucat/msg/State').subscribe((one) => !one.armed && done(one.mode))
})
// A pipe takes 64 kB at once: the rest is lost at an exit that does not wait for it.
process.stdout.write(JSON.stringify(said), () => process.exit(0))
