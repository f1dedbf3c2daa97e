// What the server answers. Addresses are relative to the page, whose address holds the token.

export interface Errors {
  max: number;
  mean: number;
  rms: number;
}

/** A level in numbers; lengths are in model units. */
export interface Level {
  level: number;
  triangles: number;
  vertices: number;
  bytes: number;
  error: Errors;
  switch_distance: number;
  flip?: number;
}

export interface ModelSummary {
  kind: 'model';
  id: number;
  name: string;
  triangles: number;
  vertices: number;
  meshes: number;
  materials: number;
  bytes: number;
  bounds: { min: [number, number, number]; max: [number, number, number] };
  diagonal: number;
  unit: string | null;
  up: string;
  attributes: string[];
  warnings: string[];
  /** Another number whenever the levels are others. */
  version: number;
  levels: Level[];
  can: { live: boolean; clusters: boolean; subdivide: boolean; heat: string[] };
}

export interface TilesetSummary {
  kind: 'tileset';
  id: number;
  name: string;
  bytes: number;
  files: number;
  root: string;
}

export type Summary = ModelSummary | TilesetSummary;

export interface ServerState {
  version: string;
  limits: { upload_bytes: number };
  files: { id: number; name: string; kind: Summary['kind']; version?: number }[];
}

export interface JobReport {
  state: 'running' | 'done' | 'cancelled' | 'failed';
  fraction: number;
  stage: string;
  error?: string;
}

export interface Legend {
  min: number;
  max: number;
  unit: string;
  map: string;
  colors: string[];
}

/** What the server said no with, or that it did not answer. */
export class Refused extends Error {
  constructor(
    message: string,
    readonly status: number,
  ) {
    super(message);
  }
}

async function ask(path: string, init?: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(`api/${path}`, init);
  } catch (error) {
    if (init?.signal?.aborted) throw error;
    throw new Refused('Karui does not answer. Is `karui view` still running?', 0);
  }
  if (response.ok) return response;
  const text = await response.text();
  let message = `${response.status} ${response.statusText}`;
  try {
    message = (JSON.parse(text) as { error?: string }).error ?? message;
  } catch {
    // Not from the API: the status says it.
  }
  throw new Refused(message, response.status);
}

async function json<T>(path: string, init?: RequestInit): Promise<T> {
  return (await ask(path, init)).json() as Promise<T>;
}

export const state = (): Promise<ServerState> => json('state');
export const summary = (id: number): Promise<Summary> => json(`files/${id}`);
export const job = (id: number): Promise<JobReport> => json(`jobs/${id}`);
export const cancel = (id: number): Promise<JobReport> => json(`jobs/${id}`, { method: 'DELETE' });

export const levelPath = (id: number, level: number): string => `files/${id}/level/${level}.glb`;
export const heatPath = (id: number, kind: string, level: number): string =>
  `files/${id}/heat/${kind}.glb?level=${level}`;
export const legend = (id: number, kind: string, level: number): Promise<Legend> =>
  json(`files/${id}/heat/${kind}.json?level=${level}`);

/** A GLB, or any other bytes. */
export const buffer = async (path: string): Promise<ArrayBuffer> => (await ask(path)).arrayBuffer();

/** Work of the server that is waited for: it is broken off with its signal, and when the page goes. */
export interface Wait {
  signal: AbortSignal;
  /** Told how far the work is, a few times a second. */
  tell(report: JobReport): void;
}

/** Time between two looks at the work, ms. */
const LOOK_EVERY = 200;

/** What `path` answers once the work for it is done. */
async function worked(path: string, { signal, tell }: Wait): Promise<Response> {
  const { job: number } = await json<{ job: number }>('jobs', { method: 'POST', signal });
  const look = () => job(number).then((report) => signal.aborted || tell(report), () => undefined);
  const timer = setInterval(() => void look(), LOOK_EVERY);
  try {
    return await ask(`${path}&job=${number}`, { signal });
  } finally {
    clearInterval(timer);
  }
}

/** A GLB of a heat map. */
export const heat = async (path: string, wait: Wait): Promise<ArrayBuffer> => (await worked(path, wait)).arrayBuffer();

/** A picture and the mean that comes with it. */
export async function flip(id: number, query: URLSearchParams, wait: Wait): Promise<{ picture: Blob; mean: number }> {
  const response = await worked(`files/${id}/flip.png?${query}`, wait);
  return { picture: await response.blob(), mean: Number(response.headers.get('x-karui-flip')) };
}

export const upload = (file: File): Promise<{ id: number }> =>
  json(`files?name=${encodeURIComponent(file.name)}`, { method: 'POST', body: file });

export const makeLods = (id: number, request: object): Promise<{ job: number }> =>
  json(`files/${id}/lod`, {
    method: 'POST',
    headers: { 'content-type': 'application/json' },
    body: JSON.stringify(request),
  });
