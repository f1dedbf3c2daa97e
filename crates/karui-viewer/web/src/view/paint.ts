// How surfaces are shown: their own material, clay, or something that is to be checked.

import {
  CanvasTexture, Color, DoubleSide, type Material, Mesh, MeshBasicMaterial, MeshLambertMaterial, MeshNormalMaterial,
  MeshStandardMaterial, NearestFilter, type Object3D, RepeatWrapping, SRGBColorSpace,
} from 'three';
import type { Look } from '../state';

export interface Finish {
  look: Look;
  flat: boolean;
  wire: boolean;
  /** Whether vertices have colours to be read as numbers. */
  heat: boolean;
}

/** What meshes were read with. */
const owned = new WeakMap<Mesh, Material | Material[]>();
/** Edges that lie over them. */
const wires = new WeakMap<Mesh, Mesh>();

/** Meshes below a root that are no overlays. */
export function meshesOf(root: Object3D): Mesh[] {
  const meshes: Mesh[] = [];
  root.traverse((object) => {
    if (object instanceof Mesh && !object.userData['overlay']) meshes.push(object);
  });
  return meshes;
}

function own(mesh: Mesh): Material | Material[] {
  const known = owned.get(mesh) ?? mesh.material;
  owned.set(mesh, known);
  return known;
}

/** Shows everything below `root` so. */
export function paint(root: Object3D, finish: Finish): void {
  for (const mesh of meshesOf(root)) {
    mesh.material = materialOf(mesh, finish);
    wireframe(mesh, finish.wire);
  }
}

/** The same once more, to be shown beside it; what is on the graphics card is shared. */
export function twin<T extends Object3D>(root: T): T {
  const copy = root.clone(true);
  const overlays: Object3D[] = [];
  copy.traverse((object) => {
    if (object.userData['overlay']) overlays.push(object);
  });
  overlays.forEach((overlay) => overlay.removeFromParent());
  const originals = meshesOf(root);
  meshesOf(copy).forEach((mesh, i) => (mesh.material = own(originals[i]!)));
  return copy;
}

function materialOf(mesh: Mesh, { look, flat, heat }: Finish): Material | Material[] {
  const read = own(mesh);
  if (heat) return colored(flat);
  if (look === 'normals') return shared(`normals${flat}`, () => normals(flat));
  if (look === 'uv') return mesh.geometry.hasAttribute('uv') ? shared(`uv${flat}`, () => checker(flat)) : clay(flat);
  if (look === 'clay') return clay(flat);
  return Array.isArray(read) ? read.map((m) => shaded(m, flat)) : shaded(read, flat);
}

const kept = new Map<string, Material>();

function shared<T extends Material>(name: string, make: () => T): Material {
  let material = kept.get(name);
  if (!material) kept.set(name, (material = make()));
  return material;
}

/** The neutral grey that models without materials have. */
export function clay(flat: boolean): Material {
  const make = () => new MeshStandardMaterial({ color: 0xb9bdc6, roughness: 0.62, metalness: 0, flatShading: flat, side: DoubleSide });
  return shared(`clay${flat}`, make);
}

/** The colours of the vertices, in the light. */
export function colored(flat: boolean): Material {
  return shared(`heat${flat}`, () => new MeshLambertMaterial({ vertexColors: true, flatShading: flat, side: DoubleSide }));
}

/** Normals as colours; backs, which should not be seen of a closed surface, are orange. */
function normals(flat: boolean): Material {
  const material = new MeshNormalMaterial({ flatShading: flat, side: DoubleSide });
  const back = 'if (!gl_FrontFacing) gl_FragColor = vec4(0.95, 0.45, 0.1, 1.0);\n}';
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace(/}\s*$/, back);
  };
  return material;
}

/** The same material, flat or not; its other half is made once. */
function shaded(material: Material, flat: boolean): Material {
  if (!('flatShading' in material) || material.flatShading === flat) return material;
  const other = material.userData['other'] as Material | undefined;
  if (other) return other;
  const made = material.clone();
  Object.assign(made, { flatShading: flat });
  made.userData = { other: material };
  material.userData['other'] = made;
  return made;
}

/** Squares of one sixteenth of the texture, numbered by brightness, whose hue tells where they lie. */
function checker(flat: boolean): Material {
  const canvas = document.createElement('canvas');
  const [cells, size] = [16, 32];
  canvas.width = canvas.height = cells * size;
  const context = canvas.getContext('2d')!;
  const color = new Color();
  for (let y = 0; y < cells; y++) {
    for (let x = 0; x < cells; x++) {
      const light = (x + y) % 2 ? 0.42 : 0.2;
      color.setHSL(0.55 + (0.5 * x) / cells, 0.35 + (0.4 * y) / cells, light);
      context.fillStyle = `#${color.getHexString()}`;
      context.fillRect(x * size, y * size, size, size);
    }
  }
  const map = new CanvasTexture(canvas);
  Object.assign(map, { wrapS: RepeatWrapping, wrapT: RepeatWrapping, colorSpace: SRGBColorSpace, magFilter: NearestFilter, anisotropy: 4, flipY: false });
  return new MeshLambertMaterial({ map, flatShading: flat, side: DoubleSide });
}

/** Edges over the surface, as a mesh of their own that shares the geometry. */
function wireframe(mesh: Mesh, on: boolean): void {
  let wire = wires.get(mesh);
  if (on && !wire) {
    const make = () =>
      new MeshBasicMaterial({
        color: 0x0b0d10, wireframe: true, transparent: true, opacity: 0.55,
        polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1,
      });
    wire = new Mesh(mesh.geometry, shared('wire', make));
    wire.userData['overlay'] = true;
    wires.set(mesh, wire);
    mesh.add(wire);
  }
  if (wire) wire.visible = on;
}

/** Frees what lies below `root` and is shared with nothing else. */
export function dispose(root: Object3D): void {
  meshesOf(root).forEach((mesh) => mesh.geometry.dispose());
}
