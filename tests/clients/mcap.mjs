// Reads an MCAP file as Foxglove and Lichtblick do, twice: along its indexes, and from its start to its end. Every checksum
// is compared, and each well-known schema with Foxglove's own. `node mcap.mjs FILE` prints what was found.
import { open, readFile } from 'node:fs/promises'
import { isDeepStrictEqual } from 'node:util'
import schemas from '@foxglove/schemas/jsonschema.js'
import { McapIndexedReader, McapStreamReader } from '@mcap/core'
import { loadDecompressHandlers } from '@mcap/support'
const [path] = process.argv.slice(2)
const decompressHandlers = await loadDecompressHandlers()

// What descriptions and comments say is no part of what is compared.
const bare = (value) => {
  if (Array.isArray(value)) return value.map(bare)
  if (typeof value !== 'object' || value === null) return value
  const told = Object.entries(value).filter(([key, one]) => !((key === 'description' || key === '$comment') && typeof one === 'string'))
  return Object.fromEntries(told.sort(([a], [b]) => (a < b ? -1 : 1)).map(([key, one]) => [key, bare(one)]))
}
const text = (bytes) => new TextDecoder().decode(bytes)

const file = await open(path)
const { size } = await file.stat()
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length))
    await file.read(bytes, 0, Number(length), Number(offset))
    return bytes
  },
}
const indexed = await McapIndexedReader.Initialize({ readable, decompressHandlers })
const found = { indexed: {}, streamed: {}, metadata: {}, attachments: {}, schemas: {}, chunks: [] }
let last = 0n
for await (const message of indexed.readMessages()) {
  if (message.logTime < last) throw new Error('messages are not in order of time')
  last = message.logTime
  const { topic } = indexed.channelsById.get(message.channelId)
  found.indexed[topic] = (found.indexed[topic] ?? 0) + 1
}
for await (const one of indexed.readMetadata()) found.metadata[one.name] = Object.fromEntries(one.metadata)
for await (const one of indexed.readAttachments({ validateCrcs: true })) found.attachments[one.name] = [one.mediaType, text(one.data)]
for (const one of indexed.chunkIndexes) found.chunks.push(one.compression)
for (const one of indexed.schemasById.values()) {
  const official = schemas[one.name.replace('foxglove.', '')]
  if (one.name.startsWith('foxglove.')) found.schemas[one.name] = isDeepStrictEqual(bare(JSON.parse(text(one.data))), bare(official))
}
const { messageCount, schemaCount, channelCount, attachmentCount, metadataCount, chunkCount } = indexed.statistics
found.statistics = { messages: Number(messageCount), schemas: schemaCount, channels: channelCount, attachments: attachmentCount, metadata: metadataCount, chunks: chunkCount }
await file.close()

const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true })
const channels = new Map()
reader.append(await readFile(path))
for (let record; (record = reader.nextRecord()); ) {
  if (record.type === 'Channel') channels.set(record.id, record.topic)
  if (record.type === 'Message') found.streamed[channels.get(record.channelId)] = (found.streamed[channels.get(record.channelId)] ?? 0) + 1
}
found.whole = reader.done()
console.log(JSON.stringify(found))
