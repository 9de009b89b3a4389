// SPDX-License-Identifier: MIT
// Decodes messages of ROS 2 with @foxglove/rosmsg2-serialization. From standard input, JSON: the definition, and the
// messages in hexadecimal; to standard output, a JSON list.
import fs from "node:fs";

import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg2-serialization";

const job = JSON.parse(fs.readFileSync(0, "utf8"));
const reader = new serialization.MessageReader(rosmsg.parse(job.definition, { ros2: true }));
const plain = (_, value) => {
  if (typeof value === "bigint") return Number(value);
  return value instanceof Uint8Array ? Buffer.from(value).toString("hex") : value;
};
console.log(JSON.stringify(job.messages.map((hex) => reader.readMessage(Buffer.from(hex, "hex"))), plain));
