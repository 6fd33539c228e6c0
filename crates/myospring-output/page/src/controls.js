// The controls of the animation, by pointer and by keyboard.

import { find } from "./elements.js";

/** @import { Player } from "./player.js" */

const PLAY = "M3 1.5v13l11-6.5z";
const PAUSE = "M3 2h3.5v12H3zM9.5 2H13v12H9.5z";
/** Steps of the arrow keys, ms. */
const STEP = 5;

/**
 * @param {Player} player
 * @param {AbortSignal} signal Ends them.
 */
export function setUpControls(player, signal) {
  const time = find("time", HTMLInputElement);
  time.min = String(player.start);
  time.max = String(player.end);
  time.step = "0.5";
  time.addEventListener("input", () => {
    player.pause();
    player.seek(Number(time.value));
  });
  const play = find("play", HTMLButtonElement);
  play.addEventListener("click", () => player.toggle());
  const speed = find("speed", HTMLSelectElement);
  speed.value = String(player.speed);
  speed.addEventListener("change", () => (player.speed = Number(speed.value)));
  const loop = find("loop", HTMLInputElement);
  loop.checked = player.loop;
  loop.addEventListener("change", () => (player.loop = loop.checked));

  const icon = document.getElementById("play-icon");
  const showState = () => {
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    icon?.setAttribute("d", player.playing ? PAUSE : PLAY);
  };
  player.addEventListener("state", showState);
  showState();
  document.addEventListener("keydown", (event) => onKey(event, player), { signal });
}

/**
 * @param {KeyboardEvent} event
 * @param {Player} player
 */
function onKey(event, player) {
  const { target } = event;
  const taken = target instanceof Element && target.closest("input, select, button, summary, pre, .wide");
  if (taken !== null && taken !== false) return;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const step = (/** @type {number} */ by) => {
    player.pause();
    player.seek(player.time + by);
  };
  /** @type {Record<string, () => void>} */
  const keys = {
    " ": () => player.toggle(),
    ArrowLeft: () => step(-STEP),
    ArrowRight: () => step(STEP),
    Home: () => step(-Infinity),
    End: () => step(Infinity),
  };
  if (event.key in keys) {
    event.preventDefault();
    keys[event.key]();
  }
}
