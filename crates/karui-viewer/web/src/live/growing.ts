// Numbers on the graphics card that grow.

import { BufferAttribute, DynamicDrawUsage } from 'three';

/** Indices between two changes that are uploaded with them: calls cost more than bytes. */
const GAP = 3000;

/** Numbers that grow, in memory that is doubled. */
export class Growing<T extends Float32Array | Uint32Array | Uint8Array> {
  attribute: BufferAttribute;

  constructor(
    private readonly make: (length: number) => T,
    private readonly size: number,
    private readonly normalized = false,
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
    return new BufferAttribute(array, this.size, this.normalized).setUsage(DynamicDrawUsage);
  }
}

export const floats = (length: number): Float32Array => new Float32Array(length);
export const words = (length: number): Uint32Array => new Uint32Array(length);
export const octets = (length: number): Uint8Array => new Uint8Array(length);
