// The socket: the latest camera wins, one request is on its way.

import { type Frame, parse } from './protocol';

/** What a socket tells. */
export interface Listener {
  ready(about: Ready): void;
  progress(stage: string, fraction: number): void;
  /** An answer, and the time since its request was sent, milliseconds. */
  frame(frame: Frame, latency: number): void;
  /** A request that could not be answered, or `fatal`: none ever will. */
  error(message: string, fatal: boolean): void;
}

/** What the server has prepared. */
export interface Ready {
  kind: string;
  triangles?: number;
  vertices: number;
  faces?: number;
  bounds: { min: [number, number, number]; max: [number, number, number] };
  seconds?: number;
  coarsest?: number;
  clusters?: number;
  /** Of the graph of clusters. */
  levels?: number;
  /** Triangles of the largest cluster. */
  slot?: number;
  cage?: { positions: number[]; edges: number[] };
}

const GONE = 'Karui does not answer any more. Is `karui view` still running? Reload the page then.';

export class Link {
  private readonly socket: WebSocket;
  private seq = 0;
  /** When the request on its way was sent; 0 if there is none. */
  private sent = 0;
  private waiting: object | null = null;
  private ready = false;
  private closed = false;

  constructor(
    path: string,
    private readonly listener: Listener,
  ) {
    const url = new URL(`api/${path}`, location.href);
    url.protocol = 'ws:';
    url.hash = '';
    this.socket = new WebSocket(url);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onmessage = ({ data }) => this.heard(data as string | ArrayBuffer);
    this.socket.onclose = () => this.fail(GONE);
  }

  /** Asks for what this message is about, in the place of what has not been sent yet. */
  ask(message: object): void {
    this.waiting = message;
    this.send();
  }

  /** Whether nothing is on its way. */
  get idle(): boolean {
    return this.ready && !this.sent && !this.waiting;
  }

  close(): void {
    this.closed = true;
    this.socket.close();
  }

  private send(): void {
    if (!this.ready || this.sent || !this.waiting || this.closed) return;
    this.seq += 1;
    this.socket.send(JSON.stringify({ seq: this.seq, ...this.waiting }));
    this.sent = performance.now();
    this.waiting = null;
  }

  private heard(data: string | ArrayBuffer): void {
    if (this.closed) return;
    try {
      if (typeof data === 'string') this.told(JSON.parse(data) as Told);
      else this.answered(parse(data));
    } catch (error) {
      this.fail(`The answer makes no sense: ${(error as Error).message}`);
    }
  }

  private answered(frame: Frame): void {
    const latency = performance.now() - this.sent;
    this.sent = 0;
    this.listener.frame(frame, latency);
    this.send();
  }

  private told({ ready, progress, error, fatal }: Told): void {
    if (progress) this.listener.progress(progress.stage, progress.fraction);
    if (error !== undefined && fatal) return this.fail(error);
    if (error !== undefined) {
      this.sent = 0;
      this.listener.error(error, false);
      this.send();
    }
    if (ready) {
      this.ready = true;
      this.listener.ready(ready);
      this.send();
    }
  }

  private fail(message: string): void {
    if (this.closed) return;
    this.close();
    this.listener.error(message, true);
  }
}

interface Told {
  ready?: Ready;
  progress?: { stage: string; fraction: number };
  error?: string;
  fatal?: boolean;
}
