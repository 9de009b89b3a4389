// SPDX-License-Identifier: MIT
// Reads a bag of loop closures with @mcap/core and @foxglove/rosmsg2-serialization, by its index, and
// prints a JSON line each.
// Usage: read.mjs LOOPS.mcap
import fs from "node:fs";

import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader } from "@mcap/core";

const bytes = fs.readFileSync(process.argv[2]);
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => bytes.subarray(Number(offset), Number(offset + length)),
  },
});
if (reader.header.profile !== "ros2") throw new Error("profile " + reader.header.profile);
let count = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  const definition = rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true });
  const decoded = new serialization.MessageReader(definition).readMessage(message.data);
  console.log(JSON.stringify(
    { topic: channel.topic, type: schema.name, log_time: message.logTime, ...decoded },
    (_, value) => (typeof value === "bigint" ? Number(value) : value)));
  ++count;
}
if (count !== reader.statistics.messageCount) throw new Error("counts differ");
