// Compressed films and pictures that the browser decodes: the engine gets their grey values.

import { make } from "./elements.js";

/** What browsers may decode; each decodes some. */
export const VIDEOS = /\.(mp4|m4v|mov|webm|mkv|ogv)$/i;
export const JPEGS = /\.jpe?g$/i;

/** Largest film, bytes of its grey values. */
const MOST_GREY = 500e6;
/** First step in search of the second frame, s, and how long a frame may take to appear, ms. */
const FIRST_STEP = 1 / 240;
const WAIT = 300;
/** Where in a frame's time it is asked for, and from what part of the usual interval on a frame may be missing before the next one. */
const WITHIN = 0.3;
const MISSING = 1.6;
/** Where a frame is sought that may be missing, in usual intervals after the last one. */
const SOONER = 0.75;

/**
 * A film as the program reads it (YUV4MPEG2, grey). It has one interval between frames, so a frame that is shown for longer is repeated:
 * the program leaves repeated frames out.
 *
 * @param {File} file
 * @param {(done: number, of: number) => void} tell Seconds of the film.
 * @returns {Promise<Uint8Array>}
 * @throws {Error} If the browser cannot decode it, or it is too long.
 */
export async function greyFilm(file, tell) {
  const video = make("video", { preload: "auto", playsinline: "" });
  video.muted = true;
  const address = URL.createObjectURL(file);
  try {
    await new Promise((resolve, reject) => {
      video.addEventListener("loadeddata", resolve, { once: true });
      video.addEventListener("error", () => reject(new Error(`this browser cannot decode ${file.name}`)), { once: true });
      video.src = address;
    });
    const frames = await framesOf(video, file.name, tell);
    return asY4m(frames, video.videoWidth, video.videoHeight);
  } finally {
    video.removeAttribute("src");
    video.load();
    URL.revokeObjectURL(address);
  }
}

/** @typedef {{ time: number, grey: Uint8Array }} Frame */

/** Every frame, one after the other. @param {HTMLVideoElement} video @param {string} name @param {(done: number, of: number) => void} tell */
async function framesOf(video, name, tell) {
  const { videoWidth: width, videoHeight: height } = video;
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (context === null) throw new Error("this browser draws no frames");
  if (!Number.isFinite(video.duration)) await at(video, 1e7);
  const { duration } = video;
  /** @type {Frame[]} */
  const frames = [];
  /** Takes the frame that is shown, unless it was taken. @param {number | null} shown Its time. */
  const take = (shown) => {
    const last = frames.at(-1)?.time ?? -Infinity;
    if (shown === null || shown <= last + 1e-6) return false;
    context.drawImage(video, 0, 0);
    if ((frames.length + 1) * width * height > MOST_GREY) throw new Error(`${name} has more than ${MOST_GREY / 1e6} MB of grey values; this page follows shorter films, the program longer ones`);
    frames.push({ time: shown, grey: greyOf(context.getImageData(0, 0, width, height).data) });
    return true;
  };
  take((await at(video, 0)) ?? 0);
  let usual = 0;
  for (let time = FIRST_STEP; time < duration && usual === 0; time += FIRST_STEP) {
    if (take(await at(video, time))) usual = frames[1].time - frames[0].time;
  }
  if (usual === 0) throw new Error(`${name} has one frame`);
  let time = frames[1].time + (1 + WITHIN) * usual;
  while (time < duration + usual) {
    const last = frames[frames.length - 1].time;
    let shown = await at(video, Math.min(time, duration));
    // What may lie between is asked for first.
    if (shown !== null && shown - last > MISSING * usual && time - last < 2 * usual) shown = await at(video, last + SOONER * usual);
    const isNew = take(shown);
    tell(Math.min(time, duration), duration);
    time = isNew ? frames[frames.length - 1].time + (1 + WITHIN) * usual : time + usual;
  }
  return frames;
}

/** Goes to a time; gives that of the frame which is then shown, s. @param {HTMLVideoElement} video @param {number} time @returns {Promise<number | null>} */
function at(video, time) {
  return new Promise((resolve) => {
    /** @type {number | null} */
    let shown = null;
    const request = video.requestVideoFrameCallback((_, { mediaTime }) => {
      shown = mediaTime;
      if (!video.seeking) end();
    });
    const seeked = () => (shown === null ? setTimeout(end, WAIT) : end());
    const end = () => {
      video.cancelVideoFrameCallback(request);
      video.removeEventListener("seeked", seeked);
      resolve(shown);
    };
    video.addEventListener("seeked", seeked);
    video.currentTime = time;
  });
}

/** Luminance (ITU-R BT.601). @param {Uint8ClampedArray} pixels Red, green, blue and opacity. */
function greyOf(pixels) {
  const grey = new Uint8Array(pixels.length / 4);
  for (let at = 0; at < grey.length; at++) grey[at] = Math.round(0.299 * pixels[4 * at] + 0.587 * pixels[4 * at + 1] + 0.114 * pixels[4 * at + 2]);
  return grey;
}

/** @param {Frame[]} frames @param {number} width @param {number} height @returns {Uint8Array} */
export function asY4m(frames, width, height) {
  const between = frames.slice(1).map(({ time }, at) => time - frames[at].time).sort((a, b) => a - b);
  const interval = between[between.length >> 1];
  const first = frames[0].time;
  const count = Math.round((frames[frames.length - 1].time - first) / interval) + 1;
  const head = new TextEncoder().encode(`YUV4MPEG2 W${width} H${height} F${Math.round(1000 / interval)}:1000 Cmono\n`);
  const mark = new TextEncoder().encode("FRAME\n");
  const size = mark.length + width * height;
  const film = new Uint8Array(head.length + count * size);
  film.set(head);
  let shown = 0;
  for (let tick = 0; tick < count; tick++) {
    while (shown + 1 < frames.length && frames[shown + 1].time <= first + (tick + 0.5) * interval) shown += 1;
    film.set(mark, head.length + tick * size);
    film.set(frames[shown].grey, head.length + tick * size + mark.length);
  }
  return film;
}

/** A picture as PNG. @param {File} file @returns {Promise<Uint8Array>} @throws {Error} If the browser cannot decode it. */
export async function asPng(file) {
  const image = await createImageBitmap(file).catch(() => {
    throw new Error(`this browser cannot decode ${file.name}`);
  });
  const canvas = new OffscreenCanvas(image.width, image.height);
  canvas.getContext("2d")?.drawImage(image, 0, 0);
  return new Uint8Array(await (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer());
}
