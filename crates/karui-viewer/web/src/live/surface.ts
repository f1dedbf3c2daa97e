// The triangles as the server has told of them: slots that are overwritten in place.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from 'three';
import { type Frame, Kind, type Reader, RESET, unfold } from './protocol';

/** Indices between two changes that are uploaded with them: calls cost more than bytes. */
const GAP = 3000;

/** Numbers that grow, in memory that is doubled. */
class Growing<T extends Float32Array | Uint32Array> {
  attribute: BufferAttribute;

  constructor(
    private readonly make: (length: number) => T,
    private readonly size: number,
  ) {
    this.attribute = this.attributeOf(make(0));
  }

  get array(): T {
    return this.attribute.array as T;
  }

  /** Whether there is another attribute now. */
  reserve(length: number): boolean {
    const { array } = this;
    if (length <= array.length) return false;
    const grown = this.make(Math.max(length, 2 * array.length, 3 << 10));
    grown.set(array);
    this.attribute = this.attributeOf(grown);
    return true;
  }

  changed(start: number, end: number): void {
    if (end <= start) return;
    const { updateRanges } = this.attribute;
    const last = updateRanges[updateRanges.length - 1];
    if (last && start >= last.start && start - (last.start + last.count) < GAP) {
      last.count = Math.max(last.count, end - last.start);
    } else {
      this.attribute.addUpdateRange(start, end - start);
    }
    this.attribute.needsUpdate = true;
  }

  private attributeOf(array: T): BufferAttribute {
    return new BufferAttribute(array, this.size).setUsage(DynamicDrawUsage);
  }
}

const floats = (length: number): Float32Array => new Float32Array(length);
const words = (length: number): Uint32Array => new Uint32Array(length);

/** Numbers of a slot, triangles of it, and line ends. */
const WIDTH = { [Kind.HalfEdge]: 3, [Kind.Clusters]: 1, [Kind.Adaptive]: 4 };

export class Surface {
  readonly geometry = new BufferGeometry();
  /** The sides of faces, of a subdivision surface alone. */
  readonly sides = new BufferGeometry();
  triangles = 0;
  private readonly position = new Growing(floats, 3);
  private readonly normal = new Growing(floats, 3);
  private readonly index = new Growing(words, 1);
  private readonly ends = new Growing(words, 1);
  private vertices = 0;
  /** Corners of every cluster, by the page's vertices. */
  private clusters: Uint32Array[] = [];

  /** `slot`: triangles of the largest cluster. */
  constructor(private readonly slot: number) {
    this.attach();
  }

  /** Makes of what is shown what the server shows. */
  apply(frame: Frame): void {
    if (frame.flags & RESET) this.clear();
    if (frame.known !== this.vertices) {
      throw new Error(`the server takes ${frame.known} vertices for known, ${this.vertices} are`);
    }
    this.append(frame);
    for (let i = 0; i < frame.definitions; i++) this.define(frame.body);
    this.place(frame);
    this.triangles = frame.triangles;
  }

  /** What is drawn: positions and corners, three numbers each. */
  mesh(): { positions: Float32Array; corners: Uint32Array } {
    const { count } = this.geometry.drawRange;
    const corners = this.index.array.slice(0, count);
    return { positions: this.position.array.slice(0, 3 * this.vertices), corners };
  }

  dispose(): void {
    this.geometry.dispose();
    this.sides.dispose();
  }

  private clear(): void {
    this.vertices = 0;
    this.clusters = [];
    this.geometry.setDrawRange(0, 0);
    this.sides.setDrawRange(0, 0);
  }

  private attach(): void {
    // What has been uploaded is too small: all goes up anew.
    this.dispose();
    for (const geometry of [this.geometry, this.sides]) {
      geometry.setAttribute('position', this.position.attribute);
      geometry.setAttribute('normal', this.normal.attribute);
    }
    this.geometry.setIndex(this.index.attribute);
    this.sides.setIndex(this.ends.attribute);
  }

  private append({ positions, normals }: Frame): void {
    const count = positions.length / 3;
    const [from, to] = [3 * this.vertices, 3 * (this.vertices + count)];
    const moved = [this.position, this.normal].map((g) => g.reserve(to));
    if (moved.some(Boolean)) this.attach();
    this.position.array.set(positions, from);
    for (let v = 0; v < count; v++) {
      unfold(normals[2 * v]!, normals[2 * v + 1]!, this.normal.array, from + 3 * v);
    }
    this.position.changed(from, to);
    this.normal.changed(from, to);
    this.vertices += count;
  }

  private define(body: Reader): void {
    body.number(); // The level.
    const [vertices, triangles] = [body.number(), body.number()];
    const numbers = new Uint32Array(vertices);
    let last = 0;
    for (let v = 0; v < vertices; v++) numbers[v] = last = body.step(last);
    const corners = body.take(3 * triangles);
    this.clusters.push(Uint32Array.from(corners, (c) => numbers[c]!));
  }

  private place({ kind, slots, runs, body }: Frame): void {
    const width = WIDTH[kind];
    const indices = kind === Kind.HalfEdge ? 3 : kind === Kind.Clusters ? 3 * this.slot : 6;
    const ends = kind === Kind.Adaptive ? 8 : 0;
    const moved = [this.index.reserve(slots * indices), this.ends.reserve(slots * ends)];
    if (moved.some(Boolean)) this.attach();
    const held = new Array<number>(width);
    let [at, last] = [0, 0];
    for (let run = 0; run < runs; run++) {
      at += body.number();
      const from = at;
      for (let rest = body.number(); rest > 0; rest--, at++) {
        for (let k = 0; k < width; k++) held[k] = last = body.step(last);
        this.set(kind, at, held);
      }
      this.index.changed(from * indices, at * indices);
      this.ends.changed(from * ends, at * ends);
    }
    this.geometry.setDrawRange(0, slots * indices);
    this.sides.setDrawRange(0, slots * ends);
  }

  private set(kind: Kind, slot: number, held: readonly number[]): void {
    if (kind === Kind.HalfEdge) return this.index.array.set(held, 3 * slot);
    if (kind === Kind.Clusters) return this.setCluster(slot, held[0]!);
    const [a, b, c, d] = held as [number, number, number, number];
    this.index.array.set([a, b, c, a, c, d], 6 * slot);
    this.ends.array.set([a, b, b, c, c, d, d, a], 8 * slot);
  }

  private setCluster(slot: number, cluster: number): void {
    const corners = this.clusters[cluster];
    if (!corners) throw new Error(`there is no cluster ${cluster}`);
    const start = 3 * this.slot * slot;
    this.index.array.set(corners, start);
    // What is left over are triangles without an area.
    this.index.array.fill(0, start + corners.length, start + 3 * this.slot);
  }
}
