// Making levels of detail, as `karui lod` does.

import * as api from '../api';
import { check, field, h } from '../dom';
import { percent } from '../format';
import type { Host } from '../mode';
import type { Display } from '../model/display';

/** Time between two looks at the work, ms. */
const LOOK_EVERY = 150;

function choice(...options: [string, string][]): HTMLSelectElement {
  return h('select', {}, ...options.map(([value, text]) => h('option', { value }, text)));
}

export class MakePanel {
  readonly element: HTMLElement;
  private readonly levels = h('input', { type: 'number', min: '1', max: '12', value: '5' });
  private readonly quality = choice(['balanced', 'balanced'], ['fast', 'fast'], ['exact', 'exact, slow']);
  private readonly border = choice(['preserve', 'held in place'], ['lock', 'untouched'], ['free', 'not held']);
  private readonly method = choice(
    ['collapse', 'edge collapse'], ['collapse-else-cluster', 'collapse, else cluster'],
    ['cluster', 'vertex clusters'], ['foliage', 'foliage'],
  );
  private readonly saliency = choice(
    ['', 'everywhere alike'], ['curvature', 'by curvature'], ['mesh', 'by mesh saliency'],
    ['image', 'by image saliency'], ['hybrid', 'by hybrid saliency'],
  );
  private readonly flip: HTMLInputElement;
  private readonly go = h('button', { type: 'button', class: 'main', onclick: () => this.start() }, 'Make levels');
  private readonly stop = h('button', { type: 'button', hidden: true, onclick: () => this.cancel() }, 'Cancel');
  private readonly bar = h('progress', { max: 1, value: 0, hidden: true, 'aria-label': 'Progress' });
  private readonly told = h('output', { class: 'told' });
  /** Called with how the work goes, and with nothing once it is over. */
  readonly tell = new Set<(line: string) => void>();
  private job: number | undefined;
  private closed = false;

  constructor(
    private readonly host: Host,
    private readonly display: Display,
    private readonly done: () => Promise<void>,
  ) {
    const [flip, box] = check('Switch by looks (FLIP 0.05)', '', () => undefined);
    this.flip = box;
    this.element = h('div', {},
      field('Levels, each half', this.levels), field('Detail', this.saliency), field('Quality', this.quality),
      field('Open borders', this.border), field('Method', this.method), flip,
      h('div', { class: 'pair' }, this.go, this.stop), this.bar, this.told,
    );
  }

  /** Begins, unless it has. */
  start(): void {
    if (this.job === undefined) void this.run();
  }

  close(): void {
    this.closed = true;
  }

  private request(): object {
    return {
      levels: Number(this.levels.value) || 5,
      quality: this.quality.value,
      border: this.border.value,
      method: this.method.value,
      ...(this.saliency.value && { saliency: this.saliency.value }),
      ...(this.flip.checked && { flip: 0.05 }),
    };
  }

  private async run(): Promise<void> {
    this.working(true);
    try {
      ({ job: this.job } = await api.makeLods(this.display.file.id, this.request()));
      await this.follow(this.job);
    } catch (error) {
      this.host.say((error as Error).message, 'error');
    } finally {
      this.job = undefined;
      this.working(false);
    }
  }

  private async follow(id: number): Promise<void> {
    while (!this.closed) {
      const job = await api.job(id);
      this.bar.value = job.fraction;
      this.say(`${job.stage}, ${percent(Math.round(100 * job.fraction) / 100)}`);
      if (job.state === 'failed') throw new Error(job.error ?? 'the work failed');
      if (job.state === 'cancelled') return this.host.say('Cancelled; the levels are as before.');
      if (job.state === 'done') return this.done();
      await new Promise((resolve) => setTimeout(resolve, LOOK_EVERY));
    }
  }

  private cancel(): void {
    if (this.job !== undefined) api.cancel(this.job).catch((error: Error) => this.host.say(error.message, 'error'));
  }

  private say(line: string): void {
    this.told.textContent = line;
    this.tell.forEach((call) => call(line));
  }

  private working(on: boolean): void {
    this.go.disabled = on;
    this.stop.hidden = this.bar.hidden = !on;
    this.say(on ? 'starting' : '');
    if (on) this.bar.value = 0;
  }
}
