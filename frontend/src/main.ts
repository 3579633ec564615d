// Styles first: what a component says of itself goes before what holds for all.
import './styles/tokens.css';
import './styles/base.css';
import './styles/forced.css';
import './styles/table.css';
import './styles/tiles.css';
import { mount } from 'svelte';
import { Access } from './access/access.svelte';
import { browserName, takeCode, takeReading } from './access/code';
import { prefetch } from './lazyPages';
import Root from './Root.svelte';
import { Router } from './router.svelte';
import { Theme } from './theme.svelte';

const place = document.getElementById('page');
if (place === null) throw new Error('index.html has no element "page"');
const protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
const access = new Access();
const open = (code: string | null, reading: string | null) => void access.open(code, browserName(navigator.userAgent), reading);
open(takeCode(), takeReading());
window.addEventListener('hashchange', () => {
  const [code, reading] = [takeCode(), takeReading()];
  if (code !== null || reading !== null) open(code, reading);
});
const router = new Router();
prefetch(router);
mount(Root, {
  target: place,
  props: { access, socket: `${protocol}//${location.host}/api/live`, router, theme: new Theme() },
});
