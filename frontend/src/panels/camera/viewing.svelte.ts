import { api, type SceneView } from '../../api';
import { Resource } from '../../resource.svelte';
import { VIEWS } from './view';

/** The bystander's view, which all pages share: each change is sent to the simulator, the newest where it is late. */
export class Viewing {
  view = $state<SceneView>(VIEWS.follow);
  readonly #request = new Resource();
  #sending = false;

  get problem(): string {
    return this.#request.problem;
  }

  readonly change = (next: SceneView): void => {
    this.view = next;
    if (!this.#sending) void this.#send();
  };

  /** Send the view as it is now, and once more where it was turned meanwhile. */
  async #send(): Promise<void> {
    this.#sending = true;
    let sent: SceneView;
    do {
      sent = this.view;
    } while ((await this.#request.run(api.view(sent))) && sent !== this.view);
    this.#sending = false;
  }
}
