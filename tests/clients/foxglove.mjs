// Does with an unmodified @foxglove/ws-protocol what Lichtblick does: `node foxglove.mjs ADDRESS VIEWER`.
import wsProtocol from '@foxglove/ws-protocol'
import { WebSocket } from 'ws'
const { FoxgloveClient } = wsProtocol
const [address, viewer] = process.argv.slice(2)
const connect = (url) => {
  const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) })
  const seen = { channels: [], services: [], latest: {}, values: {}, statuses: [] }
  const waiting = new Set()
  const once = (what) =>
    new Promise((done) => {
      const look = () => {
        const found = what()
        if (found !== undefined && found !== false) {
          waiting.delete(look)
          done(found)
        }
      }
      waiting.add(look)
      look()
    })
  const check = () => [...waiting].forEach((look) => look())
  const names = new Map()
  client.on('serverInfo', (info) => ((seen.info = info), check()))
  client.on('advertise', (channels) => (seen.channels.push(...channels), check()))
  client.on('advertiseServices', (services) => (seen.services.push(...services), check()))
  client.on('status', (status) => (seen.statuses.push(status), check()))
  client.on('time', (time) => ((seen.time = Number(time.timestamp)), check()))
  client.on('parameterValues', (said) => {
    for (const one of said.parameters) seen.values[one.name] = one.value
    seen.answered = said.id
    check()
  })
  client.on('message', ({ subscriptionId, data }) => {
    seen.latest[names.get(subscriptionId)] = JSON.parse(new TextDecoder().decode(data))
    check()
  })
  const subscribe = () => {
    for (const channel of seen.channels) names.set(client.subscribe(channel.id), channel.topic)
  }
  let number = 0
  const call = (name, fields = {}) =>
    new Promise((done) => {
      const callId = ++number
      const service = seen.services.find((one) => one.name === name)
      client.on('serviceCallResponse', (answer) => {
        if (answer.callId === callId) done(JSON.parse(new TextDecoder().decode(answer.data)))
      })
      client.on('serviceCallFailure', (answer) => answer.callId === callId && done({ refused: answer.message }))
      const data = new TextEncoder().encode(JSON.stringify(fields))
      client.sendServiceCallRequest({ serviceId: service.id, callId, encoding: 'json', data })
    })
  return { client, seen, once, subscribe, call }
}
const one = connect(address)
await one.once(() => one.seen.services.length > 0)
const said = { info: one.seen.info, channels: one.seen.channels, services: one.seen.services.map((s) => s.name) }
one.subscribe()
const topics = ['/imu', '/depth', '/tf', '/tf_static', '/pose', '/diagnostics', '/camera', '/state', '/truth']
await one.once(() => topics.every((topic) => one.seen.latest[topic]))
await one.once(() => one.seen.time)
said.latest = one.seen.latest
said.time = one.seen.time
one.client.getParameters([], 'all')
await one.once(() => one.seen.answered === 'all')
said.parameters = one.seen.values
one.client.subscribeParameterUpdates(Object.keys(one.seen.values))
const looking = connect(viewer)
await looking.once(() => looking.seen.services.length > 0)
said.refused = await looking.call('/mucat/take_control')
said.before = await one.call('/mucat/arm', { mode: 'manual' })
const name = 'vision.rate'
const rate = one.seen.values[name]
one.client.setParameters([{ name, value: rate + 1 }], 'refused')
await one.once(() => one.seen.statuses.find((status) => status.message.includes('not set')))
said.taken = await one.call('/mucat/take_control', { over: true })
looking.client.subscribeParameterUpdates([name])
one.client.setParameters([{ name, value: rate + 1 }], 'set')
await one.once(() => one.seen.answered === 'set')
said.changed = await looking.once(() => looking.seen.values[name])
one.client.setParameters([{ name, value: rate }], 'back')
await one.once(() => one.seen.answered === 'back')
said.armed = await one.call('/mucat/arm', { mode: 'manual' })
const channel = one.client.advertise({ topic: '/cmd_vel', encoding: 'json', schemaName: 'geometry_msgs/Twist' })
const twist = { linear: { x: 0.5, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 0.25 } }
const driving = setInterval(
  () => one.client.sendMessage(channel, new TextEncoder().encode(JSON.stringify(twist))),
  50,
)
said.driven = await one.once(() => one.seen.latest['/navigation']?.x > 0 && one.seen.latest['/navigation'])
clearInterval(driving)
said.stopped = await looking.call('/mucat/stop')
await one.once(() => one.seen.latest['/state'].armed === false)
// A pipe takes 64 kB at once: the rest is lost at an exit that does not wait for it.
process.stdout.write(JSON.stringify(said), () => process.exit(0))
