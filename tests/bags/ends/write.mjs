// SPDX-License-Identifier: MIT
// Writes a bag with @mcap/core: the pictures of a folder, or one picture in every encoding.
// Usage: write.mjs pictures|encodings FOLDER|- OUT.mcap none|lz4|zstd
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg2-serialization";
import { McapWriter } from "@mcap/core";

const separator = "\n" + "=".repeat(80) + "\n";
const header =
  separator + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id" +
  separator + "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec";
const types = {
  "sensor_msgs/msg/Image":
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\n" +
    "uint8 is_bigendian\nuint32 step\nuint8[] data" + header,
  "sensor_msgs/msg/CompressedImage":
    "std_msgs/Header header\nstring format\nuint8[] data" + header,
  "std_msgs/msg/String": "string data",
};

class File {
  constructor(name) {
    this.descriptor = fs.openSync(name, "w");
    this.size = 0n;
  }
  position() {
    return this.size;
  }
  async write(bytes) {
    fs.writeSync(this.descriptor, bytes);
    this.size += BigInt(bytes.byteLength);
  }
}

const [, , what, folder, out, compression] = process.argv;
const options = { writable: new File(out), chunkSize: 200_000 };
if (compression !== "none")
  // The command-line tools are as good as any library here, and Node 20 has none.
  options.compressChunk = (bytes) => ({
    compression,
    compressedData: execFileSync(compression, ["-q", "-c"], { input: bytes, maxBuffer: 1 << 30 }),
  });
const writer = new McapWriter(options);
await writer.start({ profile: "ros2", library: "@mcap/core" });
const channels = {};
for (const [name, text] of Object.entries(types))
  channels[name] = {
    schemaId: await writer.registerSchema({ name, encoding: "ros2msg", data: Buffer.from(text) }),
    serialise: new serialization.MessageWriter(rosmsg.parse(text, { ros2: true })),
    topics: {},
  };
let sequence = 0;
async function add(topic, type, time, message) {
  const channel = channels[type];
  channel.topics[topic] ??= await writer.registerChannel({
    topic, schemaId: channel.schemaId, messageEncoding: "cdr", metadata: new Map() });
  await writer.addMessage({
    channelId: channel.topics[topic], sequence: sequence++, logTime: time, publishTime: time,
    data: channel.serialise.writeMessage(message) });
}
const start = 1_700_000_000n * 1_000_000_000n;
const stamped = (time) => ({
  stamp: { sec: Number(time / 1_000_000_000n), nanosec: Number(time % 1_000_000_000n) },
  frame_id: "camera",
});

if (what === "pictures") {
  const names = fs.readdirSync(folder).filter((name) => /\.(jpg|png)$/.test(name));
  names.sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
  for (const [i, name] of names.entries()) {
    const time = start + BigInt(i) * 100_000_000n;
    await add("/talk", "std_msgs/msg/String", time, { data: "frame " + i });
    await add("/camera/compressed", "sensor_msgs/msg/CompressedImage", time + 5_000_000n, {
      header: stamped(time), format: path.extname(name).slice(1),
      data: fs.readFileSync(path.join(folder, name)) });
  }
} else {
  const [width, height] = [48, 32];
  const gray = (x, y) => (x * 5 + y * 3) % 256;
  // Bytes of one pixel.
  const layouts = {
    mono8: (g) => [g], mono16: (g) => [17, g], rgb8: (g) => [g, g, g], bgr8: (g) => [g, g, g],
    rgba8: (g) => [g, g, g, 99], bgra8: (g) => [g, g, g, 99],
  };
  for (const [encoding, layout] of Object.entries(layouts)) {
    const data = [];
    for (let y = 0; y < height; ++y)
      for (let x = 0; x < width; ++x) data.push(...layout(gray(x, y)));
    await add("/" + encoding, "sensor_msgs/msg/Image", start, {
      header: stamped(start), height, width, encoding, is_bigendian: 0,
      step: data.length / height, data: Uint8Array.from(data) });
  }
}
await writer.end();
