// From where a cell in space is seen: turned about the upward axis, tilted, enlarged. Orthographic, so that one scale holds everywhere.

/** Named places of the viewer: turned, tilted, radians. The tilt is that of his line of sight. @type {Record<string, [number, number]>} */
export const VIEWPOINTS = {
  space: [-0.4, 0.55],
  side: [0, 0],
  end: [Math.PI / 2, 0],
  along: [0, 0],
  across: [Math.PI / 2, 0],
};

/** The viewpoints for which the half of the cell that is nearer is taken away, and by which section. @type {Record<string, number>} */
export const SECTIONS = { along: 0, across: 1 };

/** Turn of an arrow key, and of a px of dragging, radians. */
const KEY = Math.PI / 18;
const DRAG = 0.008;
/** Enlargement of a key, of a px of the wheel, and its limits. */
const CLOSER = 1.25;
const WHEEL = 0.002;
const ZOOM = { least: 0.5, most: 8 };

/** Fires `turn` when it has moved. */
export class Camera extends EventTarget {
  /** Which section cuts the cell, if one does. @type {number | null} */
  section = null;
  turned = 0;
  tilted = 0;
  zoom = 1;

  /** @param {string} viewpoint One of `VIEWPOINTS`. */
  constructor(viewpoint) {
    super();
    this.stand(viewpoint);
  }

  /** Goes to a named place. @param {string} viewpoint */
  stand(viewpoint) {
    [this.turned, this.tilted] = VIEWPOINTS[viewpoint];
    this.zoom = 1;
    this.section = SECTIONS[viewpoint] ?? null;
    this.dispatchEvent(new Event("turn"));
  }

  /** Whether it is at a named place. @param {string} viewpoint */
  standsAt(viewpoint) {
    const [turned, tilted] = VIEWPOINTS[viewpoint];
    return turned === this.turned && tilted === this.tilted;
  }

  /** @param {number} about The upward axis, radians. @param {number} over Towards above, radians. @param {number} enlarged */
  turn(about, over, enlarged = 1) {
    this.turned = (this.turned + about) % (2 * Math.PI);
    this.tilted = Math.min(Math.max(this.tilted + over, -Math.PI / 2), Math.PI / 2);
    this.zoom = Math.min(Math.max(this.zoom * enlarged, ZOOM.least), ZOOM.most);
    this.dispatchEvent(new Event("turn"));
  }

  /**
   * Where places are seen: to the right, upward, and towards the viewer, as sums of what they have along the long axis, across it and
   * upward.
   *
   * @returns {[number[], number[], number[]]}
   */
  axes() {
    const [cos, sin] = [Math.cos(this.turned), Math.sin(this.turned)];
    const [high, level] = [Math.sin(this.tilted), Math.cos(this.tilted)];
    return [
      [cos, -sin, 0],
      [sin * high, cos * high, level],
      [-sin * level, -cos * level, high],
    ];
  }
}

/**
 * Lets a canvas turn a camera: a pointer drags it, two fingers or the wheel enlarge it, keys do both. One finger turns but does not tilt,
 * so that it can scroll the page; the wheel enlarges only where the canvas has the focus, for the same reason.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {Camera} camera
 */
export function letTurn(canvas, camera) {
  /** Pointers that are down, and where. @type {Map<number, [number, number]>} */
  const down = new Map();
  const middle = () => [0, 1].map((axis) => [...down.values()].reduce((sum, at) => sum + at[axis], 0) / down.size);
  const apart = () => {
    const [a, b] = down.values();
    return b === undefined ? 1 : Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 1);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!down.has(event.pointerId)) return;
    const [from, wide] = [middle(), apart()];
    down.set(event.pointerId, [event.clientX, event.clientY]);
    const to = middle();
    camera.turn(DRAG * (to[0] - from[0]), DRAG * (to[1] - from[1]), apart() / wide);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => down.delete(/** @type {PointerEvent} */ (event).pointerId));
  }
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      camera.turn(0, 0, Math.exp(-WHEEL * event.deltaY));
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    /** @type {Record<string, () => void>} */
    const keys = {
      ArrowLeft: () => camera.turn(-KEY, 0),
      ArrowRight: () => camera.turn(KEY, 0),
      ArrowUp: () => camera.turn(0, -KEY),
      ArrowDown: () => camera.turn(0, KEY),
      "+": () => camera.turn(0, 0, CLOSER),
      "=": () => camera.turn(0, 0, CLOSER),
      "-": () => camera.turn(0, 0, 1 / CLOSER),
      Home: () => camera.stand("space"),
    };
    if (!(event.key in keys)) return;
    event.preventDefault();
    // Elsewhere these keys move the time.
    event.stopPropagation();
    keys[event.key]();
  });
}
