// Writes recordings with the writer of others: node write.mjs FOLDER
import { open } from "node:fs/promises";
import { McapWriter } from "@mcap/core";

async function write(path, options) {
  const file = await open(path, "w");
  let written = 0;
  const writable = {
    position: () => BigInt(written),
    write: async (octets) => {
      await file.write(octets, 0, octets.length, written);
      written += octets.length;
    },
  };
  const writer = new McapWriter({ writable, ...options });
  await writer.start({ profile: "test", library: "another" });
  const schemaId = await writer.registerSchema({ name: "numbers", encoding: "jsonschema", data: new TextEncoder().encode("{}") });
  const channels = [];
  for (const topic of ["/a", "/b"]) {
    channels.push(await writer.registerChannel({ topic, schemaId, messageEncoding: "json", metadata: new Map([["of", topic]]) }));
  }
  if (options.silentChannel) await writer.registerChannel({ topic: "/silent", schemaId, messageEncoding: "json", metadata: new Map() });
  for (let n = 0; n < 100; n++) {
    await writer.addMessage({
      channelId: channels[n % 2],
      sequence: n,
      logTime: BigInt((n ^ 3) * 1000),
      publishTime: 5n,
      data: new TextEncoder().encode(JSON.stringify({ n })),
    });
  }
  await writer.addAttachment({ logTime: 1n, createTime: 2n, name: "note", mediaType: "text/plain", data: new TextEncoder().encode("hello") });
  await writer.addMetadata({ name: "run", metadata: new Map([["seed", "3"]]) });
  await writer.end();
  await file.close();
}

const folder = process.argv[2];
await write(`${folder}/chunks.mcap`, { chunkSize: 300 });
await write(`${folder}/silent.mcap`, { chunkSize: 300, silentChannel: true });
await write(`${folder}/no_chunks.mcap`, { useChunks: false });
await write(`${folder}/bare.mcap`, {
  useChunks: true, chunkSize: 300, useStatistics: false, useSummaryOffsets: false, repeatChannels: false, repeatSchemas: false,
  useChunkIndex: false, useMessageIndex: false, useAttachmentIndex: false, useMetadataIndex: false,
});
