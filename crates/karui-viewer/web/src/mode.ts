// What a tab is, and what it is given.

import type { Summary } from './api';
import type { Store, Tab } from './state';
import type { Stage } from './view/stage';

/** What a mode works with. */
export interface Host {
  readonly store: Store;
  readonly stage: Stage;
  /** Where its controls go; emptied before `enter`. */
  readonly panel: HTMLElement;
  /** The strip below the picture; emptied before `enter`. */
  readonly strip: HTMLElement;
  /** Lies over the picture: legends, labels. Emptied before `enter`. */
  readonly overlay: HTMLElement;
  /** A line for the user, who can do something about it if it is an error. */
  say(message: string, kind?: 'note' | 'error'): void;
  /** Reads the file's summary anew and enters the mode again. */
  reload(): Promise<void>;
}

/** A way to look at a file. */
export interface Mode {
  readonly tab: Tab;
  readonly label: string;
  /** Whether there is anything to see of this file. */
  accepts(file: Summary): boolean;
  /** Shows the file. What it throws is told to the user. */
  enter(host: Host, file: Summary): Promise<void>;
  /** The file's levels are of this version now, whoever has made them. */
  refresh?(version: number): Promise<void>;
  /** Lets go of all it has. */
  leave(): void;
  /** A key that no field wants; whether it meant something. */
  key?(event: KeyboardEvent): boolean;
  /** Keys for the help sheet: key and what it does. */
  readonly keys?: readonly (readonly [string, string])[];
}
