// Subscribes by a client that others wrote: node watch.mjs URL TOPIC... Prints a line of JSON for each topic when a sample of it has been decoded.
import protocol from "@foxglove/ws-protocol";
import { parseIDL } from "@foxglove/omgidl-parser";
import { MessageReader as IdlReader } from "@foxglove/omgidl-serialization";
import { parse as parseRos } from "@foxglove/rosmsg";
import { MessageReader as RosReader } from "@foxglove/rosmsg2-serialization";
import WebSocket from "ws";

const { FoxgloveClient } = protocol;
const [url, ...topics] = process.argv.slice(2);
const wanted = new Set(topics);
const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const decoders = new Map();

const decoder = (channel) =>
  channel.schemaEncoding === "omgidl"
    ? new IdlReader(channel.schemaName, parseIDL(channel.schema))
    : new RosReader(parseRos(channel.schema, { ros2: true }));

client.on("error", (error) => { console.error(String(error.message ?? error)); process.exit(1); });
client.on("serverInfo", (info) => console.log(JSON.stringify({ info })));
client.on("advertise", (channels) => {
  for (const channel of channels) {
    if (!wanted.has(channel.topic)) continue;
    decoders.set(client.subscribe(channel.id), { channel, reader: decoder(channel) });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { channel, reader } = decoders.get(subscriptionId);
  if (!wanted.delete(channel.topic)) return;
  const message = reader.readMessage(data);
  console.log(JSON.stringify({ topic: channel.topic, schema: channel.schemaName, time: Number(timestamp) / 1e9, message },
    (_, value) => (typeof value === "bigint" ? Number(value) : ArrayBuffer.isView(value) ? Array.from(value) : value)));
  if (wanted.size === 0) process.exit(0);
});
setTimeout(() => { console.error(`nothing came of ${[...wanted].join(", ")}`); process.exit(1); }, 60000).unref();
