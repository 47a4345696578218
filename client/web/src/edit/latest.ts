// One piece of work at a time, and of those that are asked for meanwhile the latest alone.

export class Latest<T> {
  readonly #work: (given: T) => Promise<void>;
  #next: {given: T} | undefined;
  #isBusy = false;

  constructor(work: (given: T) => Promise<void>) {
    this.#work = work;
  }

  ask(given: T): void {
    this.#next = {given};
    if (!this.#isBusy) void this.#run();
  }

  /** Forgets what has not begun. */
  drop(): void {
    this.#next = undefined;
  }

  async #run(): Promise<void> {
    this.#isBusy = true;
    while (this.#next) {
      const {given} = this.#next;
      this.#next = undefined;
      await this.#work(given);
    }
    this.#isBusy = false;
  }
}
