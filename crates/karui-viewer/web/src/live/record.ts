// A path of cameras and lights, recorded and played.

import { h } from '../dom';
import type { PathFrame, Watch } from './watch';

/** Frames of a path at most. */
const MOST = 20_000;

export class Recorder {
  readonly element: HTMLElement;
  readonly frames: PathFrame[] = [];
  private readonly start = h('button', { type: 'button', onclick: () => this.toggle() }, 'Record');
  private readonly replay = h('button', { type: 'button', onclick: () => void this.play() }, 'Play');
  private readonly save = h('button', { type: 'button', onclick: () => this.download() }, 'Save');
  private readonly label = h('output', {}, 'no path yet');
  private recording = false;
  private playing = false;

  constructor(
    private readonly watch: Watch,
    private readonly name: string,
  ) {
    this.element = h('div', { class: 'recorder' }, h('div', { class: 'row' }, this.start, this.replay, this.save), this.label);
    this.show();
  }

  toggle(): void {
    this.recording = !this.recording;
    if (this.recording) this.frames.length = 0;
    this.watch.onask = this.recording ? (frame) => this.add(frame) : null;
    // The path begins where the camera is.
    if (this.recording) this.watch.ask();
    this.show();
  }

  /** Goes along the path, answer by answer. */
  async play(): Promise<void> {
    if (this.playing) return void (this.playing = false);
    this.playing = true;
    this.show();
    for (const frame of [...this.frames]) {
      if (!this.playing) break;
      await this.watch.go(frame);
    }
    this.playing = false;
    this.show();
  }

  stop(): void {
    this.playing = false;
    this.watch.onask = null;
  }

  /** As `karui hierarchy bench --path` reads it. */
  json(): string {
    return JSON.stringify({ frames: this.frames });
  }

  private add(frame: PathFrame): void {
    this.frames.push(frame);
    if (this.frames.length >= MOST) this.toggle();
    this.show();
  }

  private download(): void {
    const url = URL.createObjectURL(new Blob([this.json()], { type: 'application/json' }));
    h('a', { href: url, download: `${this.name.replace(/\..*$/, '')}-path.json` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
  }

  private show(): void {
    const none = this.frames.length === 0;
    this.start.textContent = this.recording ? 'Stop' : 'Record';
    this.start.setAttribute('aria-pressed', String(this.recording));
    this.replay.textContent = this.playing ? 'Stop' : 'Play';
    this.replay.disabled = this.recording || none;
    this.save.disabled = this.recording || none;
    this.start.disabled = this.playing;
    this.label.textContent = none ? 'no path yet' : `${this.frames.length} frames`;
  }
}
