// Which level a distance asks for.

import type { Level } from '../api';

/** What a length of `error` looks like, pixels. */
export const pixels = (error: number, distance: number, pixelsPerRadian: number): number =>
  error === 0 ? 0 : (error * pixelsPerRadian) / distance;

/** Largest error of each level and all finer ones. */
export function errors(levels: readonly Level[]): number[] {
  let largest = 0;
  return levels.map((level) => (largest = Math.max(largest, level.error.max)));
}

/**
 * The coarsest level whose error looks no larger than `tolerance` pixels from a distance, or the
 * finest that keeps a budget of triangles if that is coarser; 0 is no budget.
 */
export function choose(
  levels: readonly Level[],
  distance: number,
  pixelsPerRadian: number,
  tolerance: number,
  budget: number,
): number {
  const seen = errors(levels).map((error) => pixels(error, distance, pixelsPerRadian));
  let level = Math.max(0, seen.findLastIndex((size) => size <= tolerance));
  while (budget > 0 && level < levels.length - 1 && levels[level]!.triangles > budget) level += 1;
  return level;
}
