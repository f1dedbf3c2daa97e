// Elements without a framework.

type Child = Node | string | null | undefined | false;
type Props = Record<string, unknown>;

/** An element with properties, attributes (`aria-label`, `for`), handlers and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  props: Props = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === false) continue;
    if (key.startsWith('on') && typeof value === 'function') {
      element.addEventListener(key.slice(2), value as EventListener);
    } else if (key.includes('-') || ['for', 'role', 'class', 'list'].includes(key)) {
      element.setAttribute(key, String(value));
    } else {
      Object.assign(element, { [key]: value });
    }
  }
  element.append(...children.filter((c): c is Node | string => Boolean(c)));
  return element;
}

/** A titled part of the panel. */
export function section(title: string, ...children: Child[]): HTMLElement {
  return h('section', {}, h('h2', {}, title), ...children);
}

let fields = 0;

/** A labelled control in a row. */
export function field(label: string, control: HTMLElement, hint?: string): HTMLElement {
  control.id ||= `field-${++fields}`;
  return h('div', { class: 'field' }, h('label', { for: control.id, title: hint ?? '' }, label), control);
}

/** A box to tick. */
export function check(label: string, key: string, onchange: (on: boolean) => void): [HTMLElement, HTMLInputElement] {
  const box = h('input', { type: 'checkbox', onchange: () => onchange(box.checked) });
  const shortcut = key && h('kbd', {}, key);
  return [h('label', { class: 'check' }, box, h('span', {}, label), shortcut || null), box];
}

/** A choice of a few, all in sight. */
export class Choice<T extends string> {
  readonly element: HTMLElement;
  private readonly buttons = new Map<T, HTMLButtonElement>();

  constructor(label: string, options: readonly (readonly [T, string])[], pick: (value: T) => void) {
    this.element = h('div', { class: 'choice', role: 'radiogroup', 'aria-label': label });
    for (const [value, text] of options) {
      const button = h('button', { type: 'button', role: 'radio', onclick: () => pick(value) }, text);
      button.addEventListener('keydown', (event) => this.step(event, value, pick));
      this.buttons.set(value, button);
      this.element.append(button);
    }
  }

  /** Shows what is chosen. */
  set(value: T): void {
    for (const [own, button] of this.buttons) {
      button.setAttribute('aria-checked', String(own === value));
      button.tabIndex = own === value ? 0 : -1;
    }
  }

  /** Lets an option be chosen, or not and why. */
  enable(value: T, on: boolean, why = ''): void {
    const button = this.buttons.get(value);
    if (button) Object.assign(button, { disabled: !on, title: on ? '' : why });
  }

  private step(event: KeyboardEvent, from: T, pick: (value: T) => void): void {
    const by = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    const open = [...this.buttons].filter(([, button]) => !button.disabled);
    const at = open.findIndex(([value]) => value === from);
    const next = open[(at + by + open.length) % open.length];
    if (!next) return;
    pick(next[0]);
    next[1].focus();
  }
}
