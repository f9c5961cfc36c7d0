// Reads a recording with readers that others wrote, and prints each message as a line of JSON: node read.mjs FILE
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader as IdlReader } from "@foxglove/omgidl-serialization";
import { parse as parseRos } from "@foxglove/rosmsg";
import { MessageReader as RosReader } from "@foxglove/rosmsg2-serialization";
import { decompress as zstd } from "fzstd";
import lz4 from "lz4js";

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, length) => {
    const octets = new Uint8Array(Number(length));
    await file.read(octets, 0, Number(length), Number(offset));
    return octets;
  },
};
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: { zstd: (octets) => zstd(octets), lz4: (octets) => new Uint8Array(lz4.decompress(octets)) },
});

const decoders = new Map();
function decoder(schema) {
  if (!decoders.has(schema.id)) {
    const text = new TextDecoder().decode(schema.data);
    decoders.set(
      schema.id,
      schema.encoding === "omgidl" ? new IdlReader(schema.name, parseIDL(text)) : new RosReader(parseRos(text, { ros2: true })),
    );
  }
  return decoders.get(schema.id);
}

const plain = (key, value) => {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value)) return Array.from(value);
  return value;
};
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  const value =
    channel.messageEncoding === "json" ? JSON.parse(new TextDecoder().decode(message.data)) : decoder(schema).readMessage(message.data);
  console.log(JSON.stringify({ time: message.logTime, topic: channel.topic, sequence: message.sequence, value }, plain));
}
const attachments = [];
for await (const attachment of reader.readAttachments()) attachments.push(attachment.name);
console.log(JSON.stringify({ attachments, statistics: reader.statistics.messageCount }, plain));
await file.close();
