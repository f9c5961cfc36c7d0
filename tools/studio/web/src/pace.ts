// How dear pictures of the world are here, and so how many pixels they have while things move. Costs are measured by a look now and then.
const wanted_cost = 10, least_share = 0.375; // [ms] of a picture while things move; the fewest pixels across

// `full`: of a picture with every pixel [ms]. `share`: of the pixels across while things move.
interface Kind { full: number; share: number; pictures: number }

export class Pace {
  // The share is the least until the first picture was measured.
  private readonly whole: Kind = { full: 0, share: least_share, pictures: 0 };
  private readonly on_backdrop: Kind = { full: 0, share: least_share, pictures: 0 };
  private kind = this.whole; // of the last picture

  // Without a GPU.
  get is_dear(): boolean {
    return this.whole.full > 0 && this.whole.share < 1;
  }

  // Of the picture that is drawn next.
  begin(has_backdrop: boolean): void {
    this.kind = has_backdrop ? this.on_backdrop : this.whole;
    this.kind.pictures += 1;
  }

  get share(): number {
    return this.kind.share;
  }

  // The first ones are dear everywhere: shaders are compiled.
  is_measured(is_at_rest: boolean): boolean {
    const { pictures } = this.kind;
    return pictures > 2 && (pictures % 16 === 3 || (is_at_rest && this.is_dear));
  }

  take(milliseconds: number, share: number): void {
    this.kind.full = milliseconds / share ** 2;
    this.kind.share = Math.min(1, Math.max(least_share, Math.round(Math.sqrt(wanted_cost / this.kind.full) * 8) / 8));
  }

  // [ms] of a picture like the last one; nothing where there is a GPU.
  cost(share: number): number {
    const cost = this.kind.full * share ** 2;
    return cost < 6 ? 0 : Math.min(cost, 500);
  }
}
