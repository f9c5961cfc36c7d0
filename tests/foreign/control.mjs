// Parameters, services and published messages by a client that others wrote: node control.mjs URL PARAMETER VALUE TOPIC JSON. Prints a line of
// JSON for each step: what the server offers, the parameter before and after, answers of services, and at the end `done` when it is told so by a line on its input.
import protocol from "@foxglove/ws-protocol";
import { createInterface } from "node:readline";
import WebSocket from "ws";

const { FoxgloveClient } = protocol;
const [url, parameter, value, topic, message] = process.argv.slice(2);
const client = new FoxgloveClient({ ws: new WebSocket(url, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const say = (line) => console.log(JSON.stringify(line));
const waiting = new Map(); // by the name of what comes
const kept = [];

// The next event of this kind that fits.
function next(kind, fits = () => true) {
  const at = kept.findIndex((one) => one.kind === kind && fits(one.event));
  if (at >= 0) return Promise.resolve(kept.splice(at, 1)[0].event);
  return new Promise((resolve) => waiting.set(kind, { fits, resolve }));
}
for (const kind of ["serverInfo", "advertiseServices", "parameterValues", "serviceCallResponse", "serviceCallFailure", "status"]) {
  client.on(kind, (event) => {
    const one = waiting.get(kind);
    if (!one?.fits(event)) return kept.push({ kind, event });
    waiting.delete(kind);
    one.resolve(event);
  });
}
client.on("error", (error) => { console.error(String(error.message ?? error)); process.exit(1); });

let calls = 0;
async function call(services, name, args) {
  const { id } = services.find((one) => one.name === name);
  const callId = ++calls;
  client.sendServiceCallRequest({ serviceId: id, callId, encoding: "json", data: new TextEncoder().encode(JSON.stringify(args)) });
  const mine = (event) => event.callId === callId;
  const answer = await Promise.race([next("serviceCallResponse", mine), next("serviceCallFailure", mine)]);
  say({ call: name, answer: answer.message ?? JSON.parse(new TextDecoder().decode(answer.data)) });
}

const info = await next("serverInfo");
const services = await next("advertiseServices");
say({ capabilities: info.capabilities, encodings: info.supportedEncodings, services: services.map((one) => one.name) });
const values = (list) => Object.fromEntries(list.parameters.map((one) => [one.name, one.value]));
client.getParameters([], "all");
say({ all: values(await next("parameterValues", (one) => one.id === "all")) });
client.subscribeParameterUpdates([parameter]);
say({ before: values(await next("parameterValues")) });
client.setParameters([{ name: parameter, value: JSON.parse(value) }], "set");
say({ set: values(await next("parameterValues", (one) => one.id === "set")) });
say({ after: values(await next("parameterValues", (one) => one.id === undefined)) });
await call(services, "/simulator/pause", {});
await call(services, "/simulator/step", { steps: 10 });
await call(services, "/simulator/contacts", { model: "nobody" });
await call(services, "/simulator/speed", {});
const channel = client.advertise({ topic, encoding: "json", schemaName: "" });
client.sendMessage(channel, new TextEncoder().encode(message));
const refused = client.advertise({ topic: "/nobody/in", encoding: "json", schemaName: "" });
say({ refused: (await next("status", (one) => one.level === 2)).message, channel: refused });
for await (const line of createInterface({ input: process.stdin })) {
  if (line === "again") client.sendMessage(channel, new TextEncoder().encode(message));
  if (line === "other") { // changed by somebody else
    say({ other: values(await next("parameterValues", (one) => one.id === undefined)) });
  }
  if (line === "end") process.exit(0);
}
