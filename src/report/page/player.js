// SPDX-License-Identifier: MIT
// The time that viewer and plots show, and how it moves.

class Player {
  /** track: `times` (s) and `frames` (indices in the run), ascending; a jump in the indices is a loss. */
  constructor(track) {
    this.times = track.times;
    this.frames = track.frames;
    this.frameEvery = track.frame_every;
    this.time = this.start;
    this.speed = 1;
    this.loop = false;
    this.playing = false;
    this.listeners = [];
  }

  get start() { return this.times.length ? this.times[0] : 0; }
  get end() { return this.times.length ? this.times.at(-1) : 0; }

  onChange(listener) { this.listeners.push(listener); }
  changed() { for (const listener of this.listeners) listener(this); }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.changed();
  }

  toggle(playing = !this.playing) {
    this.playing = playing && this.times.length > 1;
    if (this.playing && this.time >= this.end) this.time = this.start;
    this.changed();
  }

  /** To a frame itself, `count` frames on. */
  stepFrames(count) {
    const { frame, part } = this.place();
    const from = count < 0 && part > 0 ? frame + 1 : frame;
    this.playing = false;
    this.seek(this.times[Math.min(Math.max(from + count, 0), this.times.length - 1)] ?? 0);
  }

  /** Moves on by `seconds` of the reader's time. */
  advance(seconds) {
    if (!this.playing) return;
    const time = this.time + this.speed * seconds;
    if (time >= this.end && !this.loop) this.playing = false;
    this.seek(time >= this.end && this.loop ? this.start : time);
  }

  /** True where frames between `frame` and the next one shown were lost: then nothing is known of the motion. */
  isGap(frame) { return this.frames[frame + 1] - this.frames[frame] > this.frameEvery; }

  /** The frame at or before the time, and the part of the way to the next one. */
  place() {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= this.time) low = middle; else high = middle - 1;
    }
    if (low + 1 >= this.times.length || this.isGap(low)) return { frame: Math.max(low, 0), part: 0 };
    const part = (this.time - this.times[low]) / (this.times[low + 1] - this.times[low]);
    return { frame: low, part: Math.min(Math.max(part, 0), 1) };
  }
}
