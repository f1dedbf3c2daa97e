// Boot: the frame of the page, the tabs, and which file is shown.

import './style.css';
import * as api from './api';
import { App } from './app';
import { fromHash, Store } from './state';

const store = new Store(fromHash(location.hash));
const app = new App(store);
document.body.append(app.root);
addEventListener('hashchange', () => store.set(fromHash(location.hash)));

try {
  await app.start(await api.state());
} catch (error) {
  app.fail(error);
}
