// FLIP from where the camera rests, laid over the picture.

import * as api from '../api';
import { h } from '../dom';
import type { Host } from '../mode';
import { FOV } from '../view/stage';
import { type Display, FLIP } from './display';

/** Time the camera has to rest, ms. */
const REST = 250;
const MAX_SIDE = 1024;

export class FlipLayer {
  readonly element = h('img', { class: 'flip', alt: 'Where the level looks different from the original', hidden: true });
  private timer = 0;
  private request: AbortController | undefined;
  private asked = '';

  constructor(
    private readonly host: Host,
    private readonly display: Display,
    private readonly tell: (mean: number | undefined) => void,
    private readonly wait: (report: api.JobReport | undefined) => void,
  ) {}

  /** Asks for a picture unless the one that is shown is right. */
  schedule(): void {
    const key = this.host.store.state.heat === FLIP ? this.query().toString() : '';
    if (key === this.asked) return;
    this.asked = key;
    this.element.hidden = true;
    this.tell(undefined);
    this.stop();
    if (key) this.timer = window.setTimeout(() => void this.ask(), REST);
  }

  close(): void {
    this.stop();
    URL.revokeObjectURL(this.element.src);
  }

  private stop(): void {
    clearTimeout(this.timer);
    this.request?.abort();
    if (this.request) this.wait(undefined);
    this.request = undefined;
  }

  private async ask(): Promise<void> {
    const request = (this.request = new AbortController());
    const { signal } = request;
    try {
      const { picture, mean } = await api.flip(this.display.file.id, this.query(), { signal, tell: this.wait });
      if (signal.aborted) return;
      URL.revokeObjectURL(this.element.src);
      this.element.src = URL.createObjectURL(picture);
      await this.element.decode();
      this.element.hidden = false;
      this.tell(mean);
      Object.assign(window.karui, { flip: mean });
    } catch (error) {
      if (!signal.aborted) this.host.say((error as Error).message, 'error');
    } finally {
      if (this.request === request) this.stop();
    }
  }

  private query(): URLSearchParams {
    const { camera, controls, canvas } = this.host.stage;
    const shrink = Math.min(1, MAX_SIDE / Math.max(canvas.clientWidth, canvas.clientHeight));
    const side = (n: number) => String(Math.max(1, Math.round(n * shrink)));
    return new URLSearchParams({
      level: String(Math.max(0, this.display.level)),
      eye: camera.position.toArray().join(','),
      target: controls.target.toArray().join(','),
      up: '0,1,0',
      fov: String((FOV * Math.PI) / 180),
      width: side(canvas.clientWidth),
      height: side(canvas.clientHeight),
    });
  }
}
