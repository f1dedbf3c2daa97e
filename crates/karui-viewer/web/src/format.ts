// Numbers for people.

const grouped = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });

/** `12,345`. */
export const count = (n: number): string => grouped.format(n);

/** Three digits that count. */
export function number(n: number): string {
  if (n === 0) return '0';
  if (!Number.isFinite(n)) return n > 0 ? '∞' : '-';
  const size = Math.abs(n);
  if (size >= 1e6 || size < 1e-3) return n.toExponential(2).replace('e+', 'e');
  return String(Number(n.toPrecision(3)));
}

/** A share as `1.2 %`. */
export const percent = (share: number): string => `${number(100 * share)} %`;

/** `1.2 MB`. */
export function bytes(n: number): string {
  const units = ['B', 'kB', 'MB', 'GB'];
  let unit = 0;
  while (n >= 1000 && unit < units.length - 1) {
    n /= 1000;
    unit += 1;
  }
  return `${number(n)} ${units[unit]}`;
}
