// The tabs, in their order.

import type { Mode } from './mode';
import { ModelMode } from './model/mode';

export const modes: readonly Mode[] = [new ModelMode()];
