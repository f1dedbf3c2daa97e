// Scenes: 3D Tiles, streamed as a client would.

import { ImplicitTilingPlugin } from '3d-tiles-renderer/core/plugins';
import { TilesRenderer } from '3d-tiles-renderer/three';
import { Box3, Color, Group, MathUtils, Mesh, MeshLambertMaterial, type Object3D, Quaternion, Scene, Sphere, Vector3 } from 'three';
import type { Summary, TilesetSummary } from '../api';
import { Choice, check } from '../dom';
import { count, number } from '../format';
import { Facts, part } from '../live/controls';
import type { Host, Mode } from '../mode';
import { type About, Options } from '../options';
import { FOV } from '../view/stage';

type Colors = 'own' | 'group' | 'depth';

/** What of the library's tiles and counts is read here; its types leave it out. */
interface Tile {
  internal?: { depth?: number };
  engineData?: { metadata?: { parser?: { json?: Json } } | null };
}

interface Json {
  extensions?: { EXT_structural_metadata?: { propertyTables?: { count?: number }[] } };
}

interface Stats {
  queued: number;
  downloading: number;
  parsing: number;
  visible: number;
  failed: number;
}

const statsOf = (tiles: TilesRenderer): Stats => (tiles as unknown as { stats: Stats }).stats;

/** Depths from coarse to fine: cividis, which colour-blind people tell apart too. */
const DEPTHS = ['#00204c', '#31446b', '#575d6d', '#7c7b78', '#a69d75', '#d3c164', '#ffe945'];

/** Pictures without any change after which there is nothing to wait for. */
const QUIET = 4;

/** A distance of hues at which neighbours differ: the golden angle. */
const STEP = 0.38196601;

const defaults = { error: 16, colors: 'own' };

const ABOUT: About<typeof defaults> = { defaults, words: { colors: ['own', 'group', 'depth'] } };

class TilesMode implements Mode {
  readonly tab = 'tiles';
  readonly label = 'Scene';
  readonly keys = [['G', 'colours: own, group, depth'], ['F', 'freeze: keep the tiles there are']] as const;
  private host: Host | null = null;
  private tiles: TilesRenderer | null = null;
  private scene = new Scene();
  private options: Options<typeof defaults> | null = null;
  private frozen = false;
  private placed = false;
  private numbers = new Map<object, number>();
  private quiet = 0;
  private readonly failures: string[] = [];
  private readonly facts = new Facts();
  private readonly update = () => this.step();
  /** Something has changed: what is drawn may have to as well. */
  private readonly stir = () => {
    this.quiet = 0;
    this.host?.stage.invalidate();
  };

  accepts(file: Summary): boolean {
    return file.kind === 'tileset';
  }

  async enter(host: Host, file: Summary): Promise<void> {
    const { id, root, files } = file as TilesetSummary;
    Object.assign(this, { host, scene: new Scene(), placed: false, frozen: false, numbers: new Map(), quiet: 0 });
    this.options = new Options(host.store, 'tiles', ABOUT, () => this.follow());
    this.failures.length = 0;
    this.facts.clear();
    this.facts.set('Files', count(files));
    const tiles = new TilesRenderer(new URL(`api/files/${id}/tiles/${encodeURI(root)}`, location.href).href);
    this.tiles = tiles;
    tiles.registerPlugin(new ImplicitTilingPlugin());
    tiles.setCamera(host.stage.camera);
    tiles.addEventListener('load-root-tileset', () => this.place());
    tiles.addEventListener('load-model', ({ scene, tile }: { scene: Object3D; tile: object }) => this.loaded(scene, tile));
    tiles.addEventListener('dispose-model', ({ scene }: { scene: Object3D }) => forget(scene));
    tiles.addEventListener('load-error', ({ url, error }: { url: string | URL; error: Error }) => this.failed(url, error));
    tiles.addEventListener('needs-update', this.stir);
    tiles.addEventListener('tiles-load-end', this.stir);
    host.stage.moved.add(this.stir);
    this.scene.add(new Group().add(tiles.group));
    host.stage.panes = [{ scene: this.scene, from: 0, to: 1, cut: false }];
    host.stage.before.add(this.update);
    host.panel.replaceChildren(...this.controls());
    Object.assign(window.karui, { ready: false, tiles: this.tests() });
    host.stage.invalidate();
  }

  leave(): void {
    const { host, tiles } = this;
    host?.stage.before.delete(this.update);
    host?.stage.moved.delete(this.stir);
    if (host) host.stage.panes = [];
    tiles?.forEachLoadedModel(forget);
    tiles?.dispose();
    this.options?.close();
    this.tiles = this.host = this.options = null;
  }

  key(event: KeyboardEvent): boolean {
    const order: Colors[] = ['own', 'group', 'depth'];
    if (event.key === 'g') this.options?.set({ colors: order[(order.indexOf(this.colors) + 1) % 3]! });
    else if (event.key === 'f') this.freeze(!this.frozen);
    else return false;
    return true;
  }

  /** What tests read and set. */
  private tests(): object {
    return {
      failures: this.failures,
      stats: () => this.tiles && statsOf(this.tiles),
      setError: (error: number) => this.options?.set({ error }),
      paint: (colors: Colors) => this.options?.set({ colors }),
    };
  }

  private get values(): Readonly<typeof defaults> {
    return this.options?.values ?? defaults;
  }

  private get colors(): Colors {
    return this.values.colors as Colors;
  }

  /** The options have changed, by whatever. */
  private follow(): void {
    this.paint();
    this.stir();
  }

  private controls(): HTMLElement[] {
    const hint = 'Ω_t: how large an error may look; a tile with a larger one is replaced by those below';
    const options = this.options!;
    const choice = new Choice<Colors>('Colours', [['own', 'Own'], ['group', 'Group'], ['depth', 'Depth']], (colors) => options.set({ colors }));
    const [freeze, box] = check('Keep the tiles there are', 'F', (on) => this.freeze(on));
    box.dataset['freeze'] = '';
    return [
      part('Detail', options.slider('error', { label: 'Error Ω_t', unit: 'px', from: 0.5, to: 500, log: true, value: defaults.error, hint }), freeze),
      part('Colours', options.control(choice.element, () => choice.set(this.colors))),
      part('Now', this.facts.element),
    ];
  }

  private freeze(on: boolean): void {
    this.frozen = on;
    const box = this.host?.panel.querySelector<HTMLInputElement>('[data-freeze]');
    if (box) box.checked = on;
    this.stir();
  }

  /** Turns the scene so that its up is the page's, and puts its middle at the origin. */
  private place(): void {
    const { tiles, host } = this;
    const sphere = new Sphere();
    if (this.placed || !tiles || !host || !tiles.getBoundingSphere(sphere)) return;
    this.placed = true;
    // Up is away from the middle of the Earth, if the scene is on it.
    const onEarth = sphere.center.length() > 1e6;
    const up = onEarth ? sphere.center.clone().normalize() : new Vector3(0, 0, 1);
    const turn = new Quaternion().setFromUnitVectors(up, new Vector3(0, 1, 0));
    tiles.group.parent!.quaternion.copy(turn);
    tiles.group.position.copy(sphere.center).negate();
    this.scene.updateMatrixWorld(true);
    host.stage.setBounds(new Box3().setFromCenterAndSize(new Vector3(), new Vector3().setScalar((2 * sphere.radius) / Math.sqrt(3))));
    const { camera } = host.store.state;
    if (camera.length === 6) host.stage.setPose([...camera]);
    else host.stage.frame();
  }

  private step(): void {
    const { tiles, host } = this;
    if (!tiles || !host) return;
    const { stage } = host;
    tiles.errorTarget = this.values.error;
    stage.camera.updateMatrixWorld();
    if (!this.frozen) {
      tiles.setResolution(stage.camera, stage.canvas.width, stage.canvas.height);
      tiles.update();
    }
    this.place();
    this.tell();
  }

  private tell(): void {
    const { tiles, facts, host } = this;
    if (!tiles || !host) return;
    const { queued, downloading, parsing, visible, failed: refused } = statsOf(tiles);
    const busy = queued + downloading + parsing;
    const { triangles, objects } = this.count();
    const failed = Math.max(this.failures.length, refused);
    const angle = (this.values.error / host.stage.canvas.height) * 2 * Math.tan(MathUtils.degToRad(FOV) / 2);
    facts.set('Ω_t', `${number(angle)} rad`);
    facts.set('Tiles', count(visible));
    facts.set('Objects', count(objects));
    facts.set('Triangles', count(triangles));
    facts.set('On the way', count(busy));
    facts.set('Failed', count(failed));
    this.quiet = busy > 0 || !this.placed ? 0 : this.quiet + 1;
    const ready = this.quiet >= QUIET;
    Object.assign(window.karui, { triangles, ready, tileCounts: { visible, objects, triangles, busy, failed } });
    // The eye's planes are set when a picture is drawn, and found out about at the next one.
    if (!ready && failed === 0) host.stage.invalidate();
  }

  /** Triangles, instances and all, and objects: rows of the tiles' tables, else meshes. */
  private count(): { triangles: number; objects: number } {
    let [triangles, objects] = [0, 0];
    for (const tile of this.tiles?.visibleTiles ?? []) objects += rows(tile as object) ?? 0;
    const tables = objects > 0;
    this.tiles?.group.traverseVisible((object) => {
      if (!(object instanceof Mesh)) return;
      const times = 'isInstancedMesh' in object ? (object as unknown as { count: number }).count : 1;
      const { index, attributes } = object.geometry;
      triangles += (times * (index?.count ?? attributes['position']?.count ?? 0)) / 3;
      if (!tables) objects += times;
    });
    return { triangles, objects };
  }

  private failed(url: string | URL, error: Error): void {
    const name = decodeURIComponent(String(url)).replace(/^.*\/tiles\//, '');
    this.failures.push(`${name}: ${error.message}`);
    this.host?.say(`${name}: ${error.message}`, 'error');
    this.stir();
  }

  private loaded(scene: Object3D, tile: object): void {
    this.numbers.set(tile, this.numbers.size);
    this.dress(scene, tile);
    this.stir();
  }

  private paint(): void {
    this.tiles?.forEachLoadedModel((scene, tile) => this.dress(scene, tile));
    this.host?.stage.invalidate();
  }

  /** Every tile is a group of objects: one colour for all of it. */
  private dress(scene: Object3D, tile: object): void {
    const { colors } = this;
    const depth = (tile as Tile).internal?.depth ?? 0;
    const hue = ((this.numbers.get(tile) ?? 0) * STEP) % 1;
    const color = colors === 'depth' ? new Color(DEPTHS[depth % DEPTHS.length]) : new Color().setHSL(hue, 0.55, 0.55);
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.userData['own'] ??= object.material;
      const painted = object.userData['painted'] as MeshLambertMaterial | undefined;
      if (colors === 'own') return void (object.material = object.userData['own']);
      const material = painted ?? new MeshLambertMaterial({ side: 2 });
      material.color.copy(color);
      object.userData['painted'] = object.material = material;
    });
  }
}

/** Rows of the first table of a tile's content: Karui writes one a visible object. */
function rows(tile: Tile): number | undefined {
  return tile.engineData?.metadata?.parser?.json?.extensions?.EXT_structural_metadata?.propertyTables?.[0]?.count;
}

/** Frees what was made for colours. */
function forget(scene: Object3D): void {
  scene.traverse((object) => {
    const painted = object.userData['painted'] as MeshLambertMaterial | undefined;
    painted?.dispose();
    if (object instanceof Mesh && object.userData['own']) object.material = object.userData['own'];
  });
}

export const tiles: Mode = new TilesMode();
