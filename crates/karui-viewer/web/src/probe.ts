// What tests read: `window.karui`, described in README.md.

import type { App } from './app';
import type { State } from './state';

export interface Probe {
  /** Whether what the state asks for is on the screen. */
  ready: boolean;
  state: Readonly<State>;
  set(patch: Partial<State>): void;
  /** Level and triangles on the screen. */
  level: number;
  triangles: number;
  /** Pictures drawn so far. */
  frames: number;
  /** Eye and target. */
  pose(): number[];
  setPose(pose: number[]): void;
  [more: string]: unknown;
}

declare global {
  interface Window {
    karui: Probe;
  }
}

/** Begins to tell tests about the page. */
export function expose(app: App): void {
  window.karui = {
    ready: false,
    level: -1,
    triangles: 0,
    get state() {
      return app.store.state;
    },
    get frames() {
      return app.stage.frames;
    },
    set: (patch) => app.store.set(patch),
    pose: () => app.stage.pose(),
    setPose: (pose) => app.stage.setPose(pose),
  };
}
