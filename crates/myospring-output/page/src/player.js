// Time: runs, stands, jumps. Knows nothing of what is shown.

/**
 * Fires `time` when its time has moved and `state` when it starts or stops.
 */
export class Player extends EventTarget {
  /** Time, ms. */
  time;
  playing = false;
  /** Milliseconds of the cell in a millisecond of the viewer. */
  speed = 0.25;
  loop = true;
  /** Whether somebody holds the time while it plays. */
  #held = false;
  #last = 0;

  /** @param {[number, number]} span First and last time, ms. */
  constructor([start, end]) {
    super();
    this.start = start;
    this.end = end;
    this.time = start;
  }

  play() {
    if (this.playing || this.end <= this.start) return;
    if (this.time >= this.end) this.seek(this.start);
    this.playing = true;
    this.#last = performance.now();
    requestAnimationFrame(this.#step);
    this.dispatchEvent(new Event("state"));
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.dispatchEvent(new Event("state"));
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** @param {number} time Is kept within the run. */
  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.dispatchEvent(new Event("time"));
  }

  /**
   * Holds the time where it is sought while it plays, until let go.
   *
   * @param {boolean} held
   */
  hold(held) {
    this.#held = held;
  }

  /** @param {number} now */
  #step = (now) => {
    if (!this.playing) return;
    // A page that was out of sight goes on where it was.
    const passed = Math.min(Math.max(now - this.#last, 0), 100);
    this.#last = now;
    if (!this.#held) {
      const next = this.time + passed * this.speed;
      if (next < this.end) {
        this.seek(next);
      } else if (this.loop) {
        this.seek(this.start);
      } else {
        this.seek(this.end);
        this.pause();
        return;
      }
    }
    requestAnimationFrame(this.#step);
  };
}
