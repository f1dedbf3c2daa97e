// The tabs, in their order.

import { adaptive } from './adaptive';
import { live } from './live';
import type { Mode } from './mode';
import { ModelMode } from './model/mode';
import { tiles } from './tiles';

export const modes: readonly Mode[] = [new ModelMode(), live, adaptive, tiles];
