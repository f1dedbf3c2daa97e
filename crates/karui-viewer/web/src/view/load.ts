// GLBs as things to draw.

import type { Group, Mesh, MeshStandardMaterial } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import * as api from '../api';
import { clay, meshesOf } from './paint';

const loader = new GLTFLoader();

/** Parses a GLB of the server. */
async function parsed(buffer: ArrayBuffer): Promise<Group> {
  const gltf = await loader.parseAsync(buffer, '');
  const bare = !(gltf.parser.json as { materials?: unknown[] }).materials?.length;
  for (const mesh of meshesOf(gltf.scene)) {
    // Without normals in the file, smooth ones are found here; flat is a choice of its own.
    if (!mesh.geometry.hasAttribute('normal')) mesh.geometry.computeVertexNormals();
    const material = mesh.material as MeshStandardMaterial;
    if (bare && !material.vertexColors) mesh.material = clay(false);
    else if (material.flatShading) Object.assign(material, { flatShading: false, needsUpdate: true });
  }
  gltf.scene.updateMatrixWorld(true);
  return gltf.scene;
}

/** Triangles below a root. */
export function triangles(root: Group): number {
  const of = ({ geometry: { index, attributes } }: Mesh) => (index?.count ?? attributes['position']!.count) / 3;
  return meshesOf(root).reduce((sum, mesh) => sum + of(mesh), 0);
}

/** GLBs of one file, each fetched once. */
export class Shelf {
  private readonly kept = new Map<string, Promise<Group>>();

  get(path: string, fetch: (path: string) => Promise<ArrayBuffer> = api.buffer): Promise<Group> {
    const known = this.kept.get(path);
    if (known) return known;
    const group = fetch(path).then(parsed);
    this.kept.set(path, group);
    // What failed or was broken off may be asked for again.
    group.catch(() => this.kept.get(path) === group && this.kept.delete(path));
    return group;
  }

  /** Lets go of everything. */
  async clear(free: (group: Group) => void): Promise<void> {
    const groups = [...this.kept.values()];
    this.kept.clear();
    for (const group of groups) await group.then(free, () => undefined);
  }
}
