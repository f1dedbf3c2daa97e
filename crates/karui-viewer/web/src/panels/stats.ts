// The model and the level that is shown, in numbers.

import { h } from '../dom';
import { bytes, count, number, percent } from '../format';
import type { Host } from '../mode';
import { pixels } from '../model/choose';
import type { Display } from '../model/display';

export class StatsPanel {
  readonly element = h('dl', { class: 'stats' });

  constructor(
    private readonly host: Host,
    private readonly display: Display,
  ) {}

  refresh(): void {
    const lines = this.lines().flatMap(([name, value]) => [h('dt', {}, name), h('dd', {}, value)]);
    this.element.replaceChildren(...lines);
  }

  private lines(): [string, string][] {
    const { display, host } = this;
    const { file } = display;
    const row = file.levels[display.level];
    if (!row) return [];
    const unit = file.unit ?? 'units';
    const of = (n: number, whole: number) => `${count(n)} of ${count(whole)}`;
    const distance = display.distance();
    const seen = pixels(row.error.max, distance, host.stage.pixelsPerRadian);
    const share = file.diagonal > 0 ? ` (${percent(row.error.max / file.diagonal)} of the diagonal)` : '';
    const lines: [string, string][] = [
      ['Triangles', of(row.triangles, file.triangles)],
      ['Vertices', of(row.vertices, file.vertices)],
      ['Size as GLB', bytes(row.bytes)],
      ['Distance', `${number(distance)} ${unit}`],
    ];
    if (row.level > 0) {
      lines.push(
        ['Max error', `${number(row.error.max)} ${unit}${share}`],
        ['RMS error', `${number(row.error.rms)} ${unit}`],
        ['Max error here', `${number(seen)} px`],
        ['Switch at 1080p', `${number(row.switch_distance)} ${unit}`],
      );
    }
    if (row.flip !== undefined) lines.push(['FLIP there', number(row.flip)]);
    lines.push(['Diagonal', `${number(file.diagonal)} ${unit}`], ['Meshes', count(file.meshes)]);
    if (file.attributes.length) lines.push(['Vertices carry', file.attributes.join(', ')]);
    return lines;
  }
}
