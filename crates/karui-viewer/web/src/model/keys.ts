// What keys do while one model is shown.

import type { Compare, Look, Store } from '../state';
import type { Display } from './display';

export const keys = [
  ['[ ]', 'finer level, coarser level'],
  ['A', 'level by distance'],
  ['C', 'beside the original, split by a wipe, alone'],
  [', .', 'move the wipe'],
  ['W', 'edges'],
  ['F', 'flat or smooth'],
  ['1 2 3 4', 'material, clay, normals, UV checker'],
  ['H', 'next heat map'],
  ['M', 'make levels'],
] as const;

const LOOKS: Record<string, Look> = { 1: 'material', 2: 'clay', 3: 'normals', 4: 'uv' };
const NEXT: Record<Compare, Compare> = { off: 'side', side: 'wipe', wipe: 'off' };

/** Whether the key meant something. */
export function press(event: KeyboardEvent, store: Store, display: Display): boolean {
  const { state } = store;
  const level = (by: number) => {
    const last = display.file.levels.length - 1;
    store.set({ auto: false, level: Math.min(last, Math.max(0, display.level + by)) });
  };
  const wipe = (by: number) => store.set({ compare: 'wipe', wipe: Math.min(1, Math.max(0, state.wipe + by)) });
  const act: Record<string, () => void> = {
    '[': () => level(-1),
    ']': () => level(1),
    a: () => store.set({ auto: !state.auto, level: display.level }),
    c: () => store.set({ compare: NEXT[state.compare] }),
    ',': () => wipe(-0.05),
    '.': () => wipe(0.05),
    w: () => store.set({ wire: !state.wire }),
    f: () => store.set({ flat: !state.flat }),
    h: () => store.set({ heat: following(['', ...display.file.can.heat, 'flip'], state.heat) }),
  };
  const look = LOOKS[event.key];
  if (look) store.set({ look, heat: '' });
  else if (act[event.key]) act[event.key]!();
  else return false;
  return true;
}

const following = (all: string[], one: string): string => all[(all.indexOf(one) + 1) % all.length]!;
