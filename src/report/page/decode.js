// SPDX-License-Identifier: MIT
// From the text of the page to arrays. The format of the poses is that of src/report/pose_track.hpp.

const WORDS = 8; // 16-bit words per body and frame
const POSE_BYTES = 2 * WORDS;

/** Bytes of base64 text. In pieces, because a string of the whole stream would be held in memory besides. */
function bytesOf(text) {
  const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
  const bytes = new Uint8Array((text.length / 4) * 3 - padding);
  const piece = 1 << 20; // a multiple of 4: no group of digits is torn
  for (let from = 0, to = 0; from < text.length; from += piece) {
    const part = atob(text.slice(from, from + piece));
    for (let i = 0; i < part.length; ++i) bytes[to++] = part.charCodeAt(i);
  }
  return bytes;
}

const floatsOf = (text) => new Float32Array(bytesOf(text).buffer);
const indicesOf = (text) => new Uint32Array(bytesOf(text).buffer);

/** The content of a zlib stream. */
async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Sums up the differences: poses as [frames][bodies][WORDS]. */
function undoDifferences(bytes, frames, bodies) {
  const poses = new Uint16Array(frames * bodies * WORDS);
  const stride = bodies * WORDS;
  let at = 0;
  for (let frame = 0; frame < frames; ++frame) {
    for (let word = 0; word < WORDS; ++word, at += 2 * bodies) {
      let to = frame * stride + word;
      for (let body = 0; body < bodies; ++body, to += WORDS) {
        const zigzag = bytes[at + body] | (bytes[at + bodies + body] << 8);
        const before = frame > 0 ? poses[to - stride] : 0;
        poses[to] = before + ((zigzag >> 1) ^ -(zigzag & 1)); // stored modulo 2^16
      }
    }
  }
  return poses;
}

async function readPoses(text, frames, bodies) {
  if (frames === 0 || bodies === 0) return new Uint16Array(0);
  return undoDifferences(await inflate(bytesOf(text)), frames, bodies);
}
