// The triangles as the server has told of them: slots that are overwritten in place.

import { BufferGeometry, Color, SRGBColorSpace } from 'three';
import { floats, Growing, octets, words } from './growing';
import { type Frame, Kind, type Reader, RESET, unfold } from './protocol';

/** Numbers of a slot, triangles of it, and line ends. */
const WIDTH = { [Kind.HalfEdge]: 3, [Kind.Clusters]: 1, [Kind.Adaptive]: 4 };

/** A cluster as the page has it. */
interface Cluster {
  /** Number in the graph. */
  id: number;
  level: number;
  /** Its vertices among those that clusters are drawn with. */
  from: number;
  to: number;
  corners: Uint32Array;
}

/** The colour of a cluster of this number and level, 0 to 255. */
export type Painter = (cluster: number, level: number) => readonly [number, number, number];

export class Surface {
  readonly geometry = new BufferGeometry();
  /** The sides of faces, of a subdivision surface alone. */
  readonly sides = new BufferGeometry();
  triangles = 0;
  private readonly position = new Growing(floats, 3);
  private readonly normal = new Growing(floats, 3);
  private readonly index = new Growing(words, 1);
  private readonly ends = new Growing(words, 1);
  private readonly tint = new Growing(octets, 4, true);
  private vertices = 0;
  private clusters: Cluster[] = [];
  /** Vertices that clusters are drawn with: each cluster has its own, for the sake of its colour. */
  private own = 0;
  /** By slot: the cluster in it. */
  private held: number[] = [];
  private paint: Painter = () => [255, 255, 255];
  private readonly places = new Growing(floats, 3);
  private readonly directions = new Growing(floats, 3);

  /** `slot`: triangles of the largest cluster; 0 where there are no clusters. */
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
    const vertices = this.slot ? this.own : this.vertices;
    return { positions: this.position.array.slice(0, 3 * vertices), corners };
  }

  /** Of the clusters on the screen: number in the graph, level, and colour as the vertices have it. */
  colors(): { id: number; level: number; color: number[] }[] {
    return [...this.held].map((at) => {
      const { id, level, from } = this.clusters[at]!;
      return { id, level, color: [...this.tint.array.slice(4 * from, 4 * from + 3)] };
    });
  }

  /** Gives every cluster the colour that is told of its number and level, 0 to 255. */
  color(paint: Painter): void {
    this.paint = paint;
    for (const cluster of this.clusters) this.dye(cluster);
  }

  dispose(): void {
    this.geometry.dispose();
    this.sides.dispose();
  }

  private clear(): void {
    this.vertices = this.own = 0;
    this.clusters = [];
    this.held = [];
    this.geometry.setDrawRange(0, 0);
    this.sides.setDrawRange(0, 0);
  }

  private attach(): void {
    // What has been uploaded is too small: all goes up anew.
    this.dispose();
    for (const geometry of [this.geometry, this.sides]) {
      geometry.setAttribute('position', this.position.attribute);
      geometry.setAttribute('normal', this.normal.attribute);
      if (this.slot) geometry.setAttribute('color', this.tint.attribute);
    }
    this.geometry.setIndex(this.index.attribute);
    this.sides.setIndex(this.ends.attribute);
  }

  private append({ positions, normals }: Frame): void {
    const count = positions.length / 3;
    const [from, to] = [3 * this.vertices, 3 * (this.vertices + count)];
    const drawn = this.slot === 0;
    const [place, direction] = drawn ? [this.position, this.normal] : [this.places, this.directions];
    const moved = [place.reserve(to), direction.reserve(to)];
    if (drawn && moved.some(Boolean)) this.attach();
    place.array.set(positions, from);
    for (let v = 0; v < count; v++) {
      unfold(normals[2 * v]!, normals[2 * v + 1]!, direction.array, from + 3 * v);
    }
    if (drawn) for (const grown of [place, direction]) grown.changed(from, to);
    this.vertices += count;
  }

  private define(body: Reader): void {
    const [id, level, vertices, triangles] = [body.number(), body.number(), body.number(), body.number()];
    const from = this.own;
    this.own += vertices;
    const moved = [this.position, this.normal].map((g) => g.reserve(3 * this.own));
    if ([...moved, this.tint.reserve(4 * this.own)].some(Boolean)) this.attach();
    let last = 0;
    for (let v = from; v < this.own; v++) {
      last = body.step(last);
      this.position.array.set(this.places.array.subarray(3 * last, 3 * last + 3), 3 * v);
      this.normal.array.set(this.directions.array.subarray(3 * last, 3 * last + 3), 3 * v);
    }
    for (const grown of [this.position, this.normal]) grown.changed(3 * from, 3 * this.own);
    const corners = Uint32Array.from(body.take(3 * triangles), (c) => from + c);
    const cluster = { id, level, from, to: this.own, corners };
    this.clusters.push(cluster);
    this.dye(cluster);
  }

  /** Colours are told as screens have them, and lit as they are in the light. */
  private dye({ id, level, from, to }: Cluster): void {
    const [r, g, b] = this.paint(id, level);
    const light = new Color().setRGB(r / 255, g / 255, b / 255, SRGBColorSpace);
    const color = [...light.toArray().map((x) => Math.round(255 * x)), 255];
    for (let v = from; v < to; v++) this.tint.array.set(color, 4 * v);
    this.tint.changed(4 * from, 4 * to);
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
    this.held.length = this.slot ? slots : 0;
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
    const corners = this.clusters[cluster]?.corners;
    if (!corners) throw new Error(`there is no cluster ${cluster}`);
    this.held[slot] = cluster;
    const start = 3 * this.slot * slot;
    this.index.array.set(corners, start);
    // What is left over are triangles without an area.
    this.index.array.fill(0, start + corners.length, start + 3 * this.slot);
  }
}
