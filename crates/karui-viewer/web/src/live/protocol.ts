// Frames of the server, byte by byte: docs/viewer-protocol.md.

const MAGIC = 0x3156524b;
const HEADER = 64;

export const RESET = 1;
export const COMPLETE = 2;
export const TRUNCATED = 4;

export const enum Kind {
  HalfEdge = 1,
  Clusters = 2,
  Adaptive = 3,
}

export interface Frame {
  kind: Kind;
  seq: number;
  flags: number;
  /** Vertices that the page has before this frame. */
  known: number;
  /** Clusters that are defined here. */
  definitions: number;
  runs: number;
  /** Slots there are after this frame. */
  slots: number;
  triangles: number;
  microseconds: number;
  changes: [number, number];
  /** Floor in square pixels, or threshold in pixels. */
  level: number;
  bytes: number;
  /** Of the new vertices. */
  positions: Float32Array;
  /** Octahedral. */
  normals: Int16Array;
  body: Reader;
}

/** Numbers of variable length. */
export class Reader {
  private at = 0;

  constructor(private readonly bytes: Uint8Array) {}

  number(): number {
    let value = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = this.bytes[this.at++];
      if (byte === undefined || shift > 28) throw new Error('the frame ends early');
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value >>> 0;
    }
  }

  /** A number that is told by its difference from another. */
  step(from: number): number {
    const folded = this.number();
    return (from + ((folded >>> 1) ^ -(folded & 1))) >>> 0;
  }

  take(length: number): Uint8Array {
    if (this.at + length > this.bytes.length) throw new Error('the frame ends early');
    this.at += length;
    return this.bytes.subarray(this.at - length, this.at);
  }
}

/** Reads a frame as far as the variable part. */
export function parse(buffer: ArrayBuffer): Frame {
  if (buffer.byteLength < HEADER) throw new Error('the frame has no header');
  const view = new DataView(buffer);
  const word = (i: number): number => view.getUint32(4 * i, true);
  if (word(0) !== MAGIC) throw new Error('this is no frame of Karui');
  const vertices = word(5);
  const normals = HEADER + 12 * vertices;
  const body = normals + 4 * vertices;
  if (body + word(14) !== buffer.byteLength) throw new Error('the frame is not as long as it says');
  return {
    kind: word(1),
    seq: word(2),
    flags: word(3),
    known: word(4),
    definitions: word(6),
    runs: word(7),
    slots: word(8),
    triangles: word(9),
    microseconds: word(10),
    changes: [word(11), word(12)],
    level: view.getFloat32(52, true),
    bytes: buffer.byteLength,
    positions: new Float32Array(buffer, HEADER, 3 * vertices),
    normals: new Int16Array(buffer, normals, 2 * vertices),
    body: new Reader(new Uint8Array(buffer, body)),
  };
}

/** Writes the direction that two octahedral numbers stand for. */
export function unfold(x: number, y: number, to: Float32Array, at: number): void {
  x /= 32767;
  y /= 32767;
  const z = 1 - Math.abs(x) - Math.abs(y);
  const fold = Math.max(-z, 0);
  x -= x < 0 ? -fold : fold;
  y -= y < 0 ? -fold : fold;
  const length = Math.hypot(x, y, z) || 1;
  to[at] = x / length;
  to[at + 1] = y / length;
  to[at + 2] = z / length;
}
